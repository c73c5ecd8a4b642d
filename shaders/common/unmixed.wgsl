// One surface's part of a colour of the toy, in a soft picture that mixes those beside it.
//
// The importing shader declares `gbuffer_depth`, `gbuffer_base` and `gbuffer_received`.

//#import common/factor_code
//#import common/globals
//#import common/pixel
//#import common/spread
//#import common/toy_radiance

// In a heron's picture with a known motion of 5 px the low-passed error of the toy's edge is 1.48 codes with 32
// positions, and 1.43 with 64.
const N_UNMIXED: u32 = 64u;
const UNMIXED_ROW_STEP: u32 = 19u;

// The model's radiance at a texel of the physical box, relative to the gain and the tint.
fn expected_at(texel: vec2i) -> vec3f {
  let base = textureLoad(gbuffer_base, texel, 0);
  return base.rgb * toy_radiance_from(vec2f(base.a, 1.0 - base.a), textureLoad(gbuffer_received, texel, 0));
}

// Factor from the colour of the toy in a camera pixel to that of the point at its centre: the model's over
// its mean over the spread, as far as codes reach. It depends on no tint that the mixed surfaces share.
fn unmixed_factor(texel: vec2i) -> vec3f {
  if !is_soft() || textureLoad(gbuffer_depth, texel, 0) == 0.0 { return vec3f(1.0); }
  var sum = vec4f(0.0);
  for (var k = 0u; k < N_UNMIXED; k++) {
    let lattice = (vec2f(vec2u(k, k * UNMIXED_ROW_STEP % N_UNMIXED)) + 0.5) / f32(N_UNMIXED);
    let tap = vec2i(floor(vec2f(texel) + 0.5 + spread_position_px(lattice) + beside_px(k)));
    // The mixture with receivers is that of `rim`.
    if is_in_physical_box(tap) && textureLoad(gbuffer_depth, tap, 0) > 0.0 { sum += vec4f(expected_at(tap), 1.0); }
  }
  // Nothing is divided by a nearly black model.
  if sum.a == 0.0 { return vec3f(1.0); }
  let factor = (expected_at(texel) + DARKEST_USABLE) / (sum.rgb / sum.a + DARKEST_USABLE);
  return min(factor, vec3f(GREATEST_FACTOR));
}
