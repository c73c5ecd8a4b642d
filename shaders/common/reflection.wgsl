// Reflection of the receiver below the toy, relative to the gain: its surroundings, or the toy if
// it hides them.
//
//   reflectance (surroundings + hidden toy)      hidden is that part of the lobe, `toy` the toy's light above that of the surroundings
// The toy is drawn from mirror images of the eye behind the receiver, in the same way as from
// points of a light: a channel of the visibility.
// CPU reference: tests/reference/src/reflection.rs. Source: Karis 2014 (reflectance of a rough
// dielectric in even surroundings).

//#import common/globals

// Reflectance of a dielectric at normal incidence.
const FROM_ABOVE: f32 = 0.04;

// Reflectance of a rough surface; `roughness` is the square root of the lobe's width.
fn reflectance(cosine: f32, roughness: f32) -> f32 {
  let x = 1.0 - roughness;
  let y = 0.0425 - 0.0275 * roughness;
  let grazing = min(x * x, exp2(-9.28 * cosine)) * x + y;
  return FROM_ABOVE * (1.04 - 0.572 * roughness - 1.04 * grazing) + 0.022 * roughness - 0.04 + 1.04 * grazing;
}

// Reflected light for a camera in anchor space, the plane space of the first receiver. `part` is
// the visible share of the toy's image.
fn reflected_to(camera: vec3f, point: ReceiverPoint, visibility: vec4f, part: f32) -> vec3f {
  if receiver_of(point) != 0u || all(globals.reflection_channel == vec4f(0.0)) { return vec3f(0.0); }
  let to_camera = normalize(camera - vec3f(point.x, 0.0, point.y));
  let hidden = part * dot(globals.reflection_channel, 1.0 - visibility);
  let light = globals.reflected_surroundings.rgb + hidden * globals.reflected_toy.rgb;
  return reflectance(to_camera.y, globals.reflected_surroundings.a) * light;
}

// Reflected light at a point with these visibilities of a pose.
fn reflected(point: ReceiverPoint, visibility: vec4f) -> vec3f {
  return reflected_to(globals.camera_in_anchor, point, visibility, 1.0);
}
