// The tint of the toy's paint in every cell, from neighbouring cells if its surface is hidden:
// pull-push in a volume.
//
// tint = (sum shown + n d) / (sum expected + n d) of n pixels, d the darkest usable value: paint
// that is nearly black, both shown and expected, has tint 1. Sums of earlier views count, too. A cell
// that a soft picture shows in mixed pixels alone has their tint, but as a MIXED part of a view.
// A material that was never seen keeps its model's colour. One workgroup processes a material's
// grid.
//
// Reads: sums of the finest cells, accumulated sums. Writes: tints, level after level, finest
// first; afterwards the finest contains (tint, 1). CPU reference: tests/reference/src/tint.rs.
// Source: Gortler et al. 1996, section 3.4, here in a volume.

//#import common/pixel
//#import common/accumulated
//#import common/between_tints
//#import common/mixed

@group(1) @binding(0) var<storage, read> sums: array<u32>;
// Sums of tints times certainty, and of certainties.
@group(1) @binding(1) var<storage, read_write> accumulated: array<vec4f>;
@group(1) @binding(2) var<storage, read_write> tints: array<vec4f>;

const WORKGROUP: u32 = 256u;
const N_LEVELS: u32 = 5u;
// Number of pixels from which on a cell counts in full.
const FULL_PIXELS: f32 = 16.0;

fn summed(first: u32) -> vec3f {
  return vec3f(f32(sums[first]), f32(sums[first + 1u]), f32(sums[first + 2u]));
}

// Adds a cell's tint in this frame to its accumulated sum. Returns the mean, as certain as the frame or the
// sum.
fn accumulate(slot: u32) -> vec4f {
  let first = N_TINT_SUMS * slot;
  let n_pixels = f32(sums[first + 6u] & ~TINT_UNMIXED);
  if n_pixels == 0.0 { return mean_of(accumulated[slot]); }
  // All sums of a cell without an unmixed pixel have the same weight.
  let weight = select(1.0, MIXED, (sums[first + 6u] & TINT_UNMIXED) == 0u);
  let dark = weight * TINT_UNIT * DARKEST_USABLE * n_pixels;
  let tint = (summed(first) + dark) / (summed(first + 3u) + dark);
  let certainty = min(1.0, n_pixels / FULL_PIXELS);
  let sum = accumulated[slot] + vec4f(tint, 1.0) * (weight * certainty);
  accumulated[slot] = capped(sum);
  let mean = mean_of(sum);
  return mean * max(1.0, certainty / mean.a);
}

fn level_first(grid: u32, level: u32) -> u32 {
  var first = TINT_PYRAMID * grid;
  for (var l = 0u; l < level; l++) { first += TINT_CELLS >> (3u * l); }
  return first;
}

fn cell_of(index: u32, side: u32) -> vec3u {
  return vec3u(index % side, index / side % side, index / (side * side));
}

fn pull_cell(first_fine: u32, side_fine: u32, cell: vec3u) -> vec4f {
  var sum = vec4f(0.0);
  for (var k = 0u; k < 8u; k++) {
    let child = 2u * cell + vec3u(k & 1u, (k >> 1u) & 1u, k >> 2u);
    sum += tints[first_fine + tint_index(child, side_fine)];
  }
  // Eight certain children are no more certain than one.
  return sum / max(sum.a, 1.0);
}

@compute @workgroup_size(WORKGROUP)
fn cs_fill(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) grid: vec3u) {
  let finest = level_first(grid.x, 0u);
  for (var k = lane; k < TINT_CELLS; k += WORKGROUP) { tints[finest + k] = accumulate(TINT_CELLS * grid.x + k); }
  storageBarrier();
  for (var l = 1u; l < N_LEVELS; l++) {
    let side = TINT_SIDE >> l;
    let coarse = level_first(grid.x, l);
    for (var k = lane; k < side * side * side; k += WORKGROUP) {
      tints[coarse + k] = pull_cell(level_first(grid.x, l - 1u), 2u * side, cell_of(k, side));
    }
    storageBarrier();
  }
  // If certainty is missing for a whole material, its tint is 1: the model's colour.
  if lane == 0u {
    let top = level_first(grid.x, N_LEVELS - 1u);
    tints[top] += (1.0 - tints[top].a) * vec4f(1.0);
  }
  storageBarrier();
  for (var l = N_LEVELS - 1u; l > 0u; l--) {
    let side = TINT_SIDE >> (l - 1u);
    let fine = level_first(grid.x, l - 1u);
    for (var k = lane; k < side * side * side; k += WORKGROUP) {
      let own = tints[fine + k];
      let at = (vec3f(cell_of(k, side)) + 0.5) * 0.5;
      tints[fine + k] = own + (1.0 - own.a) * between_tints(level_first(grid.x, l), side / 2u, at);
    }
    storageBarrier();
  }
}
