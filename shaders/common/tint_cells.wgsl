// The cells of a grid of tints.

// Cells along each side of a grid, and in total.
const TINT_SIDE: u32 = 16u;
const TINT_CELLS: u32 = 4096u; // TINT_SIDE^3
// Sums of a cell: shown and expected colour, three channels each, and the number of pixels, with a
// bit more if one of them is not mixed.
const N_TINT_SUMS: u32 = 7u;
const TINT_UNMIXED: u32 = 0x80000000u;
// Fixed-point value of linear 1 in the sums.
const TINT_UNIT: f32 = 16384.0;

fn tint_index(cell: vec3u, side: u32) -> u32 {
  return (cell.z * side + cell.y) * side + cell.x;
}
