// A surface of the toy that has not moved: the camera's own pixel, relit.
//
// Its colour is not a mean over neighbours, so that lines of the texture remain as they are, and both
// lights are those of one point.
// The importing shader declares `gbuffer_depth`, `appearance_base`, `appearance_source`, `rim`,
// `is_other_material` and `is_point_shown`.

//#import common/camera_paint
//#import common/channels
//#import common/globals
//#import common/depth
//#import common/self_shadow
//#import common/source
//#import common/spread
//#import common/toy_radiance

// Positions of a normal distribution along one axis, in deviations, and their weights.
// Source: Gauss-Hermite quadrature with three points.
const NODE: f32 = 1.7320508;
const SIDE_WEIGHT: f32 = 0.16666667;
// Relative change of the light on a surface that is invisible, and that is fully visible.
const SAME_LIGHT: f32 = 0.02;
const OTHER_LIGHT: f32 = 0.08;

// Each light's cosine times its visibility beside a point of the toy, in steps of NODE deviations of the
// picture's spread. `place` is the point with its changes from a pixel to the next on the right, and below.
fn light_beside(is_physical: bool, place: mat3x3f, normal: vec3f, step: vec2f) -> vec4f {
  return light_received(is_physical, normal, place * vec3f(1.0, spread_px(NODE * step)));
}

// The light on a point of the toy, as radiance over base colour: the mean over the picture's spread.
fn light_on(is_physical: bool, place: mat3x3f, normal: vec3f) -> vec3f {
  var received = vec4f(0.0);
  for (var k = 0u; k < 9u; k++) {
    let step = vec2f(vec2u(k % 3u, k / 3u)) - 1.0;
    let weights = select(vec2f(1.0 - 2.0 * SIDE_WEIGHT), vec2f(SIDE_WEIGHT), step != vec2f(0.0));
    received += weights.x * weights.y * light_beside(is_physical, place, normal, step);
  }
  return toy_radiance_over_base(normal, received);
}

// Visible change of the light on a surface from `was_lit` to `lit`, from 0 to 1.
fn light_change(lit: vec3f, was_lit: vec3f) -> f32 {
  let brighter = max(largest(was_lit), largest(lit));
  if brighter == 0.0 { return 0.0; }
  return smoothstep(SAME_LIGHT, OTHER_LIGHT, largest(abs(lit - was_lit)) / brighter);
}

// Whether the light at the outermost positions of a soft picture's spread is the same in both poses.
fn is_lit_alike(shown: mat3x3f, normal: vec3f, before: mat3x3f, normal_before: vec3f) -> bool {
  for (var k = 0u; k < 4u; k++) {
    let corner = 2.0 * vec2f(vec2u(k & 1u, k >> 1u)) - 1.0;
    let lit = toy_radiance_over_base(normal, light_beside(false, shown, normal, corner));
    let was_lit = toy_radiance_over_base(normal_before, light_beside(true, before, normal_before, corner));
    if light_change(lit, was_lit) > 0.0 { return false; }
  }
  return true;
}

// Whether a pixel mixes the toy with a receiver alone, in known parts.
fn is_unmixed(texel: vec2i) -> bool {
  if !is_soft() { return false; }
  let part = textureLoad(rim, texel, 0).a;
  return part >= LEAST_PART && part < 1.0;
}

// Whether the camera's pixel at a texel of the region shows a point of the physical toy at `physical_px`
// and `depth` with the base colour `base`, and no other surface of the toy. A thin part of other paint
// that lies on the point has about its depth, so other paint counts only if the point itself is shown.
fn is_seen_still(in_region: vec2i, physical_px: vec2f, depth: f32, base: vec3f) -> bool {
  let texel = physical_texel(in_region);
  if !is_in_physical_box(texel) || !is_same_surface(textureLoad(gbuffer_depth, texel, 0), depth) { return false; }
  let is_one = number_at(textureLoad(appearance_source, texel, 0)) == number_of(vec2i(0));
  if !is_one && !is_unmixed(texel) { return false; }
  if !is_other_material(textureLoad(appearance_base, texel, 0).rgb, base) { return true; }
  let low = floor(physical_px - 0.5);
  return is_point_shown(low, physical_px - 0.5 - low, depth);
}
