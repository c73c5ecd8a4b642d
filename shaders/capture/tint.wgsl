// Shown and expected colours of the toy's visible paint, summed in cells.
//
// Each pixel that shows one surface of the toy, and is not clipped, adds its colour, and the one
// expected from base colour, gain and fitted light, to the cell that contains its point. In a soft
// picture the colour is unmixed, and a pixel that another surface is mixed into counts less. Sums are
// of integers: their order does not matter.
//
// Reads: frame, validity, gbuffer, fit, reflection of a glossy toy. Writes: sums of the finest
// cells. CPU reference: tests/reference/src/tint.rs.

//#import common/fit
//#import common/frame
//#import common/pixel
//#import common/channels
//#import common/tint_grid
//#import common/tint_cells
//#import common/marks
//#import common/toy_point
//#import common/unmixed

// Sampling stride in pixels along each side, chosen so that no sum overflows.
@group(1) @binding(0) var<uniform> stride_px: u32;
@group(1) @binding(1) var<uniform> tint_grid: TintGrid;
@group(1) @binding(2) var<storage, read_write> sums: array<atomic<u32>>;
@group(1) @binding(3) var validity: texture_2d<f32>;
@group(1) @binding(4) var gbuffer_depth: texture_depth_2d;
// w is the material's index.
@group(1) @binding(5) var gbuffer_normal: texture_2d<f32>;
@group(1) @binding(6) var gbuffer_received: texture_2d<f32>;
@group(1) @binding(7) var gbuffer_base: texture_2d<f32>;
// The reflection of a glossy toy.
@group(1) @binding(8) var reflected: texture_2d<f32>;

override IS_GLOSSY: bool = false;

// Larger expected values are clipped in the photograph for every paint; the limit also bounds the
// sums.
const MOST_EXPECTED: f32 = 3.0;

// The paint's part of a pixel's colour, without the reflection.
fn paint_at(in_box: vec2i, shown: vec3f) -> vec3f {
  if !IS_GLOSSY { return shown; }
  return max(shown - fit.gain.rgb * textureLoad(reflected, in_box, 0).rgb, vec3f(0.0));
}

@compute @workgroup_size(8, 8)
fn cs_add(@builtin(global_invocation_id) id: vec3u) {
  // The samples are the same texels of the region, independent of the box.
  let start = (vec2u(globals.physical_box_origin_px) + stride_px - 1u) / stride_px;
  let texel = (start + id.xy) * stride_px;
  let in_box = physical_texel(vec2i(texel));
  let one_surface = marks_at(vec2i(texel)).g;
  if !is_in_physical_box(in_box) || one_surface == 0.0 { return; }
  let expected = fit.gain.rgb * expected_at(in_box);
  let seen = frame_at(vec2i(texel));
  if largest(seen) > BRIGHTEST_USABLE { return; }
  if IS_GLOSSY && textureLoad(reflected, in_box, 0).a < 1.0 { return; }
  let shown = unmixed_factor(in_box) * paint_at(in_box, seen);
  let place = tint_place(seen_in_anchor(vec2f(texel) + 0.5, textureLoad(gbuffer_depth, in_box, 0)));
  let cell = vec3u(clamp(place, vec3f(0.0), vec3f(f32(TINT_SIDE - 1u))));
  let first = N_TINT_SUMS * (TINT_CELLS * tint_grid_of(u32(textureLoad(gbuffer_normal, in_box, 0).w)) + tint_index(cell, TINT_SIDE));
  for (var channel = 0u; channel < 3u; channel++) {
    atomicAdd(&sums[first + channel], u32(one_surface * shown[channel] * TINT_UNIT));
    atomicAdd(&sums[first + 3u + channel], u32(one_surface * min(expected[channel], MOST_EXPECTED) * TINT_UNIT));
  }
  atomicAdd(&sums[first + 6u], 1u);
  if one_surface == 1.0 { atomicOr(&sums[first + 6u], TINT_UNMIXED); }
}
