// Usable 8-bit codes. A code under 10 is mostly quantisation (half a step is 5 % of the value at
// 10) and one above 250 may be clipped. The bounds are these codes in linear light.
const DARKEST_USABLE: f32 = 0.00303527;
const BRIGHTEST_USABLE: f32 = 0.95597335;

// 1 per channel if both values are usable, otherwise 0.
fn is_usable(a: vec3f, b: vec3f) -> vec3f {
  let low = min(a, b);
  let high = max(a, b);
  return select(vec3f(0.0), vec3f(1.0), low >= vec3f(DARKEST_USABLE) & high <= vec3f(BRIGHTEST_USABLE));
}
// Weight of a pixel that may be clipped in both pictures: in a fully clipped region no change is
// visible, and none must be made.
const CLIPPED_WEIGHT: f32 = 1e-3;

// 1 per channel if both values may be clipped, otherwise 0.
fn is_clipped(a: vec3f, b: vec3f) -> vec3f {
  return select(vec3f(0.0), vec3f(1.0), min(a, b) > vec3f(BRIGHTEST_USABLE));
}

// Weight of a pixel of frame and plate as evidence of the light there, per channel.
fn evidence_of(frame: vec3f, plate: vec3f) -> vec3f {
  return is_usable(frame, plate) + CLIPPED_WEIGHT * is_clipped(frame, plate);
}
