// The cells of a grid of tints.

// Cells along each side of a grid, and all of them.
const TINT_SIDE: u32 = 16u;
const TINT_CELLS: u32 = 4096u; // TINT_SIDE^3
// Sums of a cell: what is shown and what is expected, three channels each, and how many pixels they are of.
const N_TINT_SUMS: u32 = 7u;
// Linear 1 in the sums.
const TINT_UNIT: f32 = 16384.0;

fn tint_index(cell: vec3u, side: u32) -> u32 {
  return (cell.z * side + cell.y) * side + cell.x;
}
