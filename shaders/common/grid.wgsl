// Coarse grids over the receivers, in plane space: cells stay in place when the camera moves.

struct Grid {
  // Corner of the first cell.
  origin_in_plane: vec2f,
  cell_m: f32,
  // Index of this receiver's first cell; all levels of its pyramid follow.
  first_cell: u32,
  // Number of cells of the finest level, at most 64 x 64.
  size: vec2u,
  _pad: vec2u,
}

struct Grids {
  grids: array<Grid, 4u>,
}

// Maximum number of cells of a finest level.
const MAX_CELLS: u32 = 4096u;

@group(1) @binding(0) var<uniform> grids: Grids;
