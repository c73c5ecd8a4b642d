// Paint of the toy as the camera's pixels show it, relit.
//
// The importing shader declares `appearance_base`, `appearance_received`, `appearance_source`, `rim`,
// `unmixed`, `reflected` and IS_GLOSSY.

//#import common/fit
//#import common/factor_code
//#import common/frame
//#import common/source
//#import common/spread
//#import common/toy_radiance

// Maximum factor by which a camera pixel is brightened or darkened for a turned surface.
const MAX_TURN: f32 = 4.0;
// Factor by which paint may differ from the model's for a pixel to be relit in full. Of 1.5, 1.25, 1.1
// and 1 the toy's error was least at 1.1: without a limit 5.54 codes for a heron, 8.83 if blurred, 4.30
// for a llama; with it 5.20, 8.02, 4.20; with 1 a phone's and two more captures were worse again.
const OTHER_PAINT: f32 = 1.1;
// Part of a pixel from which the toy's own colour is unmixed: below, noise would be amplified.
const LEAST_PART: f32 = 0.35;
// Error of the toy's part of a pixel over the relative one of its model's colour. Of 0, .2 and .67 the toy's
// error is 2.92, 2.71 and 2.69 codes for a fox in a motion by 5 px, 4.64, 4.19 and 4.11 for a husky on
// checked cloth, 6.80, 6.94 and 7.03 for a heron on a pale table.
const PART_ERROR: f32 = 0.2;
// Smallest part of the paint in a pixel's light.
const LEAST_PAINT: f32 = 0.1;
// Distance in pixels within which the camera's brightness is compared with the model's; largest
// difference of the upward parts of two surfaces with the same light.
const COMPARED_PX: i32 = 2;
const SAME_UP: f32 = 0.1;
// Factors by which the model is brighter up to which it stays, and from which the camera's brightness is
// taken; the largest one. A photographed cube has 190 pixels beyond 40 codes of those around them
// without it, 142 with it, and its true picture 121; if small factors count, too, the toy's error
// rises from 2.97 to 3.09 codes where model and light are exact, since texture is taken for light. If
// the model is darker, it stays: background beyond the outline counts, too (an edge out of focus
// 3.76 for 3.64).
const SAME_BRIGHTNESS: f32 = 1.2;
const OTHER_BRIGHTNESS: f32 = 1.6;
const MOST_BRIGHTNESS: f32 = 2.0;
const LUMINANCE = vec3f(0.2126, 0.7152, 0.0722);

// The light on the camera's colour at a texel of the physical box, as radiance over base colour.
fn seen_under(texel: vec2i) -> vec3f {
  let up = textureLoad(appearance_base, texel, 0).a;
  return toy_radiance_from(vec2f(up, 1.0 - up), textureLoad(appearance_received, texel, 0));
}

// Reflected radiance at a texel of the physical box.
fn seen_reflected(texel: vec2i) -> vec3f {
  return select(vec3f(0.0), textureLoad(reflected, texel, 0).rgb, IS_GLOSSY);
}

// A camera pixel relit from `was_lit` to `lit`, both radiance over base colour, but no further than to
// about the model's colour `expected` in that light: a shadow that is not where the model has it is
// not removed from a lit pixel, nor added to a dark one.
fn relit(color: vec3f, lit: vec3f, was_lit: vec3f, expected: vec3f) -> vec3f {
  let turn = select(vec3f(1.0), lit / was_lit, was_lit > vec3f(0.0));
  let turned = color * clamp(turn, vec3f(1.0 / MAX_TURN), vec3f(MAX_TURN));
  return clamp(turned, min(color, expected / OTHER_PAINT), max(color, expected * OTHER_PAINT));
}

// The toy's own colour at a texel of the physical box, without what a soft picture mixes into it.
fn own_color(texel: vec2i) -> vec3f {
  let seen = frame_at(region_texel(texel));
  if !is_soft() { return seen; }
  let mixed = textureLoad(rim, texel, 0);
  let part = max(mixed.a, LEAST_PART);
  return max(seen - (1.0 - part) * fit.gain.rgb * mixed.rgb, vec3f(0.0)) / part;
}

// How far a pixel of the physical box tells the paint, beside the model; 1 inside the outline. Where a soft
// picture mixes the receiver into it, an error of the toy's part is multiplied by the difference between
// receiver and toy, and divided by that part.
// Source: the mean of two measurements, each weighted by the inverse of its variance.
fn told_of(texel: vec2i) -> f32 {
  if !is_soft() { return 1.0; }
  let mixed = textureLoad(rim, texel, 0);
  if mixed.a == 0.0 || mixed.a == 1.0 { return 1.0; }
  let expected = dot(textureLoad(appearance_base, texel, 0).rgb * seen_under(texel), LUMINANCE);
  let error = PART_ERROR * (dot(mixed.rgb, LUMINANCE) - expected) / max(mixed.a, LEAST_PART);
  return select(1.0, expected * expected / (expected * expected + error * error), error != 0.0);
}

// The colour of the paint at a texel of the physical box; alpha is how far that is known.
fn paint_color(texel: vec2i) -> vec4f {
  let color = own_color(texel);
  if !IS_GLOSSY { return vec4f(color, told_of(texel)); }
  let there = textureLoad(reflected, texel, 0);
  return vec4f(max(color - fit.gain.rgb * there.rgb, LEAST_PAINT * color), there.a * told_of(texel));
}

// The same without other surfaces of the toy that a soft picture mixes into it.
fn unmixed_paint(texel: vec2i) -> vec4f {
  let paint = paint_color(texel);
  if !is_soft() { return paint; }
  return vec4f(factor_of_code(textureLoad(unmixed, texel, 0).rgb), 1.0) * paint;
}

// Factor for the model's colour at a point of which no camera pixel shows the paint: the camera's
// brightness around a texel of the physical box over the model's, if that is brighter, down to a half,
// on surfaces that face up as much as `up`. `tint` is the point's. The pooled tint may be that of other
// sides nearby.
fn brightness_beside(texel: vec2i, up: f32, tint: vec3f) -> f32 {
  var sum = vec2f(0.0);
  for (var y = -COMPARED_PX; y <= COMPARED_PX; y++) {
    for (var x = -COMPARED_PX; x <= COMPARED_PX; x++) {
      let other = texel + vec2i(x, y);
      if !is_in_physical_box(other) { continue; }
      if number_at(textureLoad(appearance_source, other, 0)) != number_of(vec2i(0)) { continue; }
      let base = textureLoad(appearance_base, other, 0);
      if abs(base.a - up) > SAME_UP { continue; }
      let shown = paint_color(other);
      let expected = fit.gain.rgb * tint * base.rgb * seen_under(other);
      sum += shown.a * vec2f(dot(shown.rgb, LUMINANCE), dot(expected, LUMINANCE));
    }
  }
  if sum.x == 0.0 || sum.y == 0.0 { return 1.0; }
  let brighter = sum.y / sum.x;
  let part = smoothstep(log(SAME_BRIGHTNESS), log(OTHER_BRIGHTNESS), log(brighter));
  return pow(clamp(brighter, 1.0, MOST_BRIGHTNESS), -part);
}
