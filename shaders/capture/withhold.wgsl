// Validity mask without the real shadow, to measure its reconstruction on a photograph without
// ground truth.
//
// Reads: validity, visibility, ambient. Writes: the same mask, but 0 if the receiver is in shadow,
// as if the toy hid it; a is then 0, and a half beside the toy.
// CPU reference: tests/reference/src/withhold.rs.

//#import common/model
//#import common/channels
//#import common/fullscreen

@group(1) @binding(0) var validity: texture_2d<f32>;
@group(1) @binding(1) var visibility: texture_2d<f32>;
@group(1) @binding(2) var ambient: texture_2d<f32>;
@group(1) @binding(3) var ambient_sampler: sampler;

// Remaining light, in plates, below which a pixel is in the real shadow.
const LIT: f32 = 0.95;

@fragment
fn fs_withhold(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2u(position.xy);
  let marks = textureLoad(validity, texel, 0);
  let point = receiver_point(position.xy);
  if !is_hit(point) || marks.r == 0.0 { return marks; }
  let a = textureSampleLevel(ambient, ambient_sampler, position.xy / globals.region_size_px, 0.0).r;
  let left = receiver_model(point, a, textureLoad(visibility, texel, 0));
  return select(marks, vec4f(0.0, 0.0, 0.0, 0.5 * (1.0 - marks.b)), smallest(left) < LIT);
}
