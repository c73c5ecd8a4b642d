// Pooling in the cells of coarse grids, and accumulation with their earlier values.
//
// A cell samples a fixed set of points of its receiver, independent of pixels, so that it does not
// swim when the camera moves.

//#import common/globals
//#import common/grid
//#import common/accumulated

// Cells of values times their certainty, all levels of the pyramids; pooling writes the finest.
@group(1) @binding(1) var<storage, read_write> cells: array<vec4f>;
// Earlier values: sums of values times certainty, and of certainties, for the finest levels alone.
@group(1) @binding(2) var<storage, read_write> accumulated: array<vec4f>;

// Sampled points of a cell: all of them, or a quarter, which changes from picture to picture.
struct Taken {
  // Stride along each side.
  stride: u32,
  _pad: u32,
  first: vec2u,
}

@group(1) @binding(3) var<uniform> taken: Taken;

// Number of a cell's points along each side.
const N_POINTS: u32 = 8u;
// Fraction of a cell's points that must be valid for the cell to count in full.
const FULL_SHARE: f32 = 0.25;

// A receiver whose cells have no extent is out of reach.
fn is_cell(receiver: u32, cell: vec2u) -> bool {
  let grid = grids.grids[receiver];
  return all(cell < grid.size) && grid.cell_m > 0.0;
}

fn n_taken() -> u32 {
  let n_side = N_POINTS / taken.stride;
  return n_side * n_side;
}

// The sampled point number `k` of a cell's N_POINTS x N_POINTS points.
fn point_of_cell(receiver: u32, cell: vec2u, k: u32) -> ReceiverPoint {
  let grid = grids.grids[receiver];
  let n_side = N_POINTS / taken.stride;
  let point = taken.first + taken.stride * vec2u(k % n_side, k / n_side);
  let within = (vec2f(point) + 0.5) / f32(N_POINTS);
  return point_on(receiver, grid.origin_in_plane + (vec2f(cell) + within) * grid.cell_m);
}

// Adds a cell's value, from `n_points` valid ones of the sampled points, to the accumulated sums.
fn accumulate(receiver: u32, cell: vec2u, value: vec3f, n_points: f32) {
  let grid = grids.grids[receiver];
  let certainty = min(1.0, n_points / (FULL_SHARE * f32(n_taken())));
  let index = cell.y * grid.size.x + cell.x;
  let slot = receiver * MAX_CELLS + index;
  let sum = accumulated[slot] + vec4f(value, 1.0) * certainty;
  accumulated[slot] = capped(sum);
  cells[grid.first_cell + index] = mean_of(sum);
}
