// Usable 8-bit codes. A code under 10 is mostly quantisation (half a step is 5 % of the value at 10) and one above
// 250 may be clipped. Bounds are those codes in linear light.
const DARKEST_USABLE: f32 = 0.00303527;
const BRIGHTEST_USABLE: f32 = 0.95597335;

// 1 per channel where both values are usable, else 0.
fn is_usable(a: vec3f, b: vec3f) -> vec3f {
  let low = min(a, b);
  let high = max(a, b);
  return select(vec3f(0.0), vec3f(1.0), low >= vec3f(DARKEST_USABLE) & high <= vec3f(BRIGHTEST_USABLE));
}
