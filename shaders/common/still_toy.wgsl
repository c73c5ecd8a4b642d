// A surface of the toy that has not moved: the camera's own pixel, relit.
//
// Its colour is not taken from neighbours, so that folds and lines of the texture remain as they are, and
// both lights are those of one point.
// The importing shader declares `gbuffer_depth`, `rim`, `moved_mask`, `seen_under` and IS_COARSE.

//#import common/globals
//#import common/depth
//#import common/self_shadow
//#import common/spread
//#import common/toy_radiance

// Positions of a normal distribution along one axis, in deviations, and their weights.
// Source: Gauss-Hermite quadrature with three points.
const NODE: f32 = 1.7320508;
const SIDE_WEIGHT: f32 = 0.16666667;

// The light on a point of the toy, as radiance over base colour: the mean over the picture's spread.
// `place` is the point with its changes from a pixel to the next on the right, and below.
fn light_on(is_physical: bool, place: mat3x3f, normal: vec3f) -> vec3f {
  var received = vec4f(0.0);
  for (var k = 0u; k < 9u; k++) {
    let step = vec2f(vec2u(k % 3u, k / 3u)) - 1.0;
    let offset_px = spread_px(NODE * step);
    let weights = select(vec2f(1.0 - 2.0 * SIDE_WEIGHT), vec2f(SIDE_WEIGHT), step != vec2f(0.0));
    let at = place * vec3f(1.0, offset_px);
    received += weights.x * weights.y * light_received(is_physical, normal, at);
  }
  return toy_radiance_over_base(normal, received);
}

// Whether nothing at a texel of the toy box, or near enough to be mixed with it, has moved.
fn is_all_still(in_box: vec2i) -> bool {
  var most = textureLoad(moved_mask, clamped_to_box(in_box), 0).r;
  for (var k = 0u; k < 4u; k++) {
    let side = select(vec2i(1, 0), vec2i(0, 1), k >= 2u) * (1 - 2 * i32(k & 1u));
    most = max(most, textureLoad(moved_mask, clamped_to_box(in_box + side), 0).r);
  }
  if most > 0.0 || !is_soft() { return most == 0.0; }
  for (var k = 0u; k < N_ON_RING; k++) {
    most = max(most, textureLoad(moved_mask, clamped_to_box(on_ring(in_box, 0.5 * soft_reach_px(), k)), 0).r);
    most = max(most, textureLoad(moved_mask, clamped_to_box(on_ring(in_box, soft_reach_px(), k)), 0).r);
  }
  return most == 0.0;
}

// Whether a texel of the physical box shows nothing but the toy, or the part of it that does is known.
fn is_inside_outline(texel: vec2i) -> bool {
  if is_soft() { return textureLoad(rim, texel, 0).a >= LEAST_PART; }
  for (var k = 0u; k < 9u; k++) {
    let other = texel + vec2i(vec2u(k % 3u, k / 3u)) - 1;
    if !is_in_physical_box(other) || textureLoad(gbuffer_depth, other, 0) == 0.0 { return false; }
  }
  return true;
}

// Whether the camera's pixel at a texel of the region shows a still surface of this depth.
fn is_seen_still(in_region: vec2i, in_box: vec2i, depth: f32) -> bool {
  let texel = physical_texel(in_region);
  if !is_in_physical_box(texel) || !is_same_surface(textureLoad(gbuffer_depth, texel, 0), depth) { return false; }
  return is_inside_outline(texel) && is_all_still(in_box);
}
