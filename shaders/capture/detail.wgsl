// Each pixel's own residual, denoised in the real shadow.
//
// A shadow is the noisiest part of a photograph, and the plate has the same texture without it: the
// residual is smoothed over a few pixels, and only the removed detail that exceeds the noise is
// restored. Light that is not in shadow keeps its pixels unchanged.
//
// Reads: frame, plate, validity, visibility, ambient. Writes: r, in plates.
// CPU reference: tests/reference/src/detail.rs.
// Source: thresholding of detail as in Donoho 1995; smoothing guided by the plate, which divides
// out the texture, as in Eisemann and Durand 2004.

//#import common/fit
//#import common/frame
//#import common/model
//#import common/pixel
//#import common/reflection
//#import common/channels
//#import common/fullscreen
//#import common/marks

@group(1) @binding(0) var plate: texture_2d<f32>;
@group(1) @binding(1) var validity: texture_2d<f32>;
@group(1) @binding(2) var visibility: texture_2d<f32>;
@group(1) @binding(3) var ambient: texture_2d<f32>;
@group(1) @binding(4) var ambient_sampler: sampler;

const RADIUS_PX: i32 = 3;
// Detail, in plates, up to which it is only noise, and from which it is kept in full.
const NOISE: f32 = 0.03;
const DETAIL: f32 = 0.08;
// Remaining light, in plates, below which a pixel is in shadow, and from which it is not.
const SHADOW: f32 = 0.85;
const LIT: f32 = 0.98;

// Adds a pixel's plate times residual, and its plate squared, if the frame shows the receiver.
// Returns the model there, and 1 otherwise.
fn add_own(texel: vec2i, receiver: u32, product: ptr<function, vec3f>, energy: ptr<function, vec3f>) -> vec3f {
  let at = vec2f(texel) + 0.5;
  if any(at < vec2f(0.0)) || any(at >= globals.region_size_px) { return vec3f(1.0); }
  let point = receiver_point(at);
  let b = textureLoad(plate, texel, 0);
  if receiver_of(point) != receiver || marks_at(texel).r == 0.0 || b.a < 1.0 { return vec3f(1.0); }
  let v = textureLoad(visibility, texel, 0);
  let f = frame_at(texel) / fit.gain.rgb - reflected(point, v);
  let a = textureSampleLevel(ambient, ambient_sampler, at / globals.region_size_px, 0.0).r;
  let model = receiver_model(point, a, v);
  // Ratios to a nearly black plate are noise.
  let lit = select(vec3f(0.0), b.rgb, b.rgb >= vec3f(DARKEST_USABLE));
  *product += lit * (f - b.rgb * model);
  *energy += lit * lit;
  return model;
}

fn ratio(product: vec3f, energy: vec3f) -> vec3f {
  return select(vec3f(0.0), product / energy, energy > vec3f(0.0));
}

@fragment
fn fs_separate(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy);
  let receiver = receiver_of(receiver_point(position.xy));
  if receiver == MAX_RECEIVERS { return vec4f(0.0); }
  var product = vec3f(0.0);
  var energy = vec3f(0.0);
  let left = largest(add_own(texel, receiver, &product, &energy));
  let exact = ratio(product, energy);
  if left >= LIT { return vec4f(exact, 1.0); }
  product = vec3f(0.0);
  energy = vec3f(0.0);
  for (var y = -RADIUS_PX; y <= RADIUS_PX; y++) {
    for (var x = -RADIUS_PX; x <= RADIUS_PX; x++) {
      add_own(texel + vec2i(x, y), receiver, &product, &energy);
    }
  }
  let smooth_residual = ratio(product, energy);
  let detail = exact - smooth_residual;
  let size = largest(abs(detail));
  let filtered = smooth_residual + detail * smoothstep(NOISE, DETAIL, size);
  return vec4f(mix(filtered, exact, smoothstep(SHADOW, LIT, left)), 1.0);
}
