// The value of a coarse grid at a receiver's point.

//#import common/globals
//#import common/grid
//#import common/between_cells

fn cell_at(point: ReceiverPoint) -> vec4f {
  let receiver = receiver_of(point);
  let cell_m = grids.grids[receiver].cell_m;
  if cell_m == 0.0 { return vec4f(0.0); }
  let in_cells = (point.xy - grids.grids[receiver].origin_in_plane) / cell_m;
  return between_cells(grids.grids[receiver].first_cell, grids.grids[receiver].size, in_cells - 0.5);
}
