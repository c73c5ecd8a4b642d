// Fills the cells that the toy hides from their neighbours: pull-push on the grids of residuals or
// lit colours.
//
// Pull halves the grid and sums values times certainties; push fills the uncertain part of each
// cell from the coarser level. One workgroup processes a receiver's grid: it has at most 64 x 64
// cells.
//
// Reads and writes: cells, level after level in one buffer, finest first. Afterwards the finest
// contains (value, 1), or 0 if the whole grid is empty.
// CPU reference: tests/reference/src/fill.rs. Source: Gortler et al. 1996, section 3.4.

//#import common/grid
//#import common/between_cells

@group(1) @binding(1) var<storage, read_write> cells: array<vec4f>;

const WORKGROUP: u32 = 256u;
// 64 cells halve to one in six steps.
const N_LEVELS: u32 = 7u;

struct Level {
  first: u32,
  size: vec2u,
}

fn level(grid: Grid, index: u32) -> Level {
  var l = Level(grid.first_cell, grid.size);
  for (var i = 0u; i < index; i++) { l = Level(l.first + l.size.x * l.size.y, (l.size + 1u) / 2u); }
  return l;
}

fn pull_cell(fine: Level, cell: vec2u) -> vec4f {
  var sum = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let child = cell * 2u + vec2u(k & 1u, k >> 1u);
    if all(child < fine.size) { sum += cells[fine.first + child.y * fine.size.x + child.x]; }
  }
  // Four certain children are no more certain than one.
  return sum / max(sum.a, 1.0);
}

fn push_cell(coarse: Level, cell: vec2u) -> vec4f {
  return between_cells(coarse.first, coarse.size, (vec2f(cell) + 0.5) * 0.5 - 0.5);
}

@compute @workgroup_size(WORKGROUP)
fn cs_pull_push(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) receiver: vec3u) {
  let grid = grids.grids[receiver.x];
  for (var l = 1u; l < N_LEVELS; l++) {
    let fine = level(grid, l - 1u);
    let coarse = level(grid, l);
    for (var k = lane; k < coarse.size.x * coarse.size.y; k += WORKGROUP) {
      cells[coarse.first + k] = pull_cell(fine, vec2u(k % coarse.size.x, k / coarse.size.x));
    }
    storageBarrier();
  }
  // The coarsest cell, normalised, fills cells for which no finer level has data.
  if lane == 0u {
    let top = level(grid, N_LEVELS - 1u).first;
    if cells[top].a > 0.0 { cells[top] /= cells[top].a; }
  }
  storageBarrier();
  for (var l = N_LEVELS - 1u; l > 0u; l--) {
    let coarse = level(grid, l);
    let fine = level(grid, l - 1u);
    for (var k = lane; k < fine.size.x * fine.size.y; k += WORKGROUP) {
      let own = cells[fine.first + k];
      cells[fine.first + k] = own + (1.0 - own.a) * push_cell(coarse, vec2u(k % fine.size.x, k / fine.size.x));
    }
    storageBarrier();
  }
}
