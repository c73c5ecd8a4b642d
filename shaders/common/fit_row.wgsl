// A channel's row of sums of `fit`: upper triangle of the symmetric matrix row by row, followed by the
// right-hand side and the clipped pixels' part of the matrix' first element.

const N_SUMS: u32 = 28u;
const RIGHT_SUM: u32 = 21u;
const CLIPPED_SUM: u32 = 27u;
