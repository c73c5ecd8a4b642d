// The plate, completed by an estimate in pixels that no plate covers.
//
// If the fits have found the shadow, it is B = (frame - gain reflected) / (gain M), 0 at least, per pixel of the
// receiver, with all its texture, if enough light remains. Pixels that the toy hides, or bleeds
// into, stay smooth, as in the fits.
// Reads: plate, frame, validity, visibility, ambient, lit cells. Writes: linear colour, with alpha
// 1 if it was photographed, and less if it is an estimate.
// CPU reference: tests/reference/src/estimate.rs.

//#import common/fit
//#import common/frame
//#import common/model
//#import common/channels
//#import common/completed
//#import common/fullscreen
//#import common/marks
//#import common/reflection

@group(1) @binding(1) var<storage, read> cells: array<vec4f>;
@group(1) @binding(2) var plate: texture_2d<f32>;
@group(1) @binding(3) var validity: texture_2d<f32>;
@group(1) @binding(4) var visibility: texture_2d<f32>;
@group(1) @binding(5) var ambient: texture_2d<f32>;
@group(1) @binding(6) var ambient_sampler: sampler;

// Remaining light, in plates, above which a pixel's own estimate is used in full, and below which
// it is not used.
const TELLS_ALL: f32 = 0.3;
const TELLS_NONE: f32 = 0.1;

@fragment
fn fs_complete(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2u(position.xy);
  let photographed = textureLoad(plate, texel, 0);
  let point = receiver_point(position.xy);
  if photographed.a == 1.0 || !is_hit(point) { return photographed; }
  let smooth_color = completed(photographed, point);
  if marks_at(vec2i(texel)).b == 0.0 { return smooth_color; }
  let f = frame_at(vec2i(texel));
  let a = textureSampleLevel(ambient, ambient_sampler, position.xy / globals.region_size_px, 0.0).r;
  let v = textureLoad(visibility, texel, 0);
  let model = receiver_model(point, a, v);
  let left = smallest(model);
  if left <= TELLS_NONE { return smooth_color; }
  let own = max(f - fit.gain.rgb * reflected(point, v), vec3f(0.0)) / (fit.gain.rgb * model);
  return vec4f(mix(smooth_color.rgb, own, smoothstep(TELLS_NONE, TELLS_ALL, left)), smooth_color.a);
}
