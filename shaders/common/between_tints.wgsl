// Trilinear interpolation of tints.

//#import common/tint_cells

// Cells of all levels of a grid: 16, 8, 4, 2 and 1 along each side, finest first.
const TINT_PYRAMID: u32 = 4681u;

// Tint in the level of a grid that begins at `first`; `at` is in its cells.
fn between_tints(first: u32, side: u32, at: vec3f) -> vec4f {
  let low = floor(at - 0.5);
  let t = at - 0.5 - low;
  var sum = vec4f(0.0);
  for (var k = 0u; k < 8u; k++) {
    let corner = vec3f(f32(k & 1u), f32((k >> 1u) & 1u), f32(k >> 2u));
    let cell = vec3u(clamp(low + corner, vec3f(0.0), vec3f(f32(side - 1u))));
    let weights = mix(1.0 - t, t, corner);
    sum += weights.x * weights.y * weights.z * tints[first + tint_index(cell, side)];
  }
  return sum;
}
