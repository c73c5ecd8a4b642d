// Counting of a pixel's covered positions.

const N_POSITIONS: u32 = 32u;
// Increment per covered position, in 8-bit codes, into which all positions fit.
const COVERED_CODES: u32 = 7u;
const COVERED_POSITION: f32 = f32(COVERED_CODES) / 255.0;
