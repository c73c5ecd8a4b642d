// The value of a coarse grid at a receiver's point.

fn cell_at(point: ReceiverPoint) -> vec4f {
  let grid = grids.grids[point.receiver];
  if grid.cell_m == 0.0 { return vec4f(0.0); }
  return between_cells(grid.first_cell, grid.size, (point.in_plane - grid.origin_in_plane) / grid.cell_m - 0.5);
}
