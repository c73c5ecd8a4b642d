// Grain of computed pixels: the part of the camera's noise that they lack.

//#import common/globals
//#import common/grain
//#import common/spread

// Whether computed pixels get the camera's noise.
override HAS_GRAIN: bool = false;
// Part of a pixel's variance that may be missing without correction.
const ENOUGH_MISSING: f32 = 0.2;

// Variance that the receiver's pixel lacks, compared with the camera's pixels there.
var<private> missing: vec3f;

// Sets the missing variance. `own` is the weight of the frame's pixel `f`; the rest is the plate
// `b` times `lit`. A softened or estimated plate has no noise.
fn missing_beside(color: vec3f, own: f32, f: vec3f, b: vec4f, lit: vec3f) -> vec3f {
  let wanted = variance_of(drawing.frame_noise, color);
  let made = (1.0 - own) * lit;
  let left = wanted - own * own * variance_of(drawing.frame_noise, f) - made * made * select(vec3f(0.0), variance_of(drawing.plate_noise, b.rgb), b.a == 1.0 && !is_soft());
  return select(vec3f(0.0), left, left > ENOUGH_MISSING * wanted);
}

// A colour with noise of this variance and the same mean.
fn grained(color: vec3f, texel: vec2i, variance: vec3f) -> vec3f {
  if all(variance <= vec3f(0.0)) { return color; }
  let at = texel + vec2i(globals.region_origin_px);
  let noise = sqrt(max(variance, vec3f(0.0))) * grain_at(at, drawing.picture, drawing.grain_weights, drawing.channels);
  let room = max(min(color, 1.0 - color), vec3f(0.0));
  return color + clamp(noise, -room, room);
}

// A pixel with this part of a moved toy: its colours are means over neighbours, which have less
// noise.
fn grained_toy(color: vec3f, texel: vec2i, moved: f32) -> vec3f {
  if !HAS_GRAIN { return color; }
  let of_toy = (1.0 - resampled_variance(drawing.grain_weights)) * variance_of(drawing.frame_noise, color);
  return grained(color, texel, mix(missing, of_toy, moved));
}
