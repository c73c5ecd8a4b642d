// Reflection of the receiver below the toy, relative to the gain: its surroundings, or the toy if
// it hides them.
//
//   reflectance (surroundings + hidden toy)      hidden is that part of the lobe, `toy` the toy's light above that of the surroundings
// The toy is drawn from mirror images of the eye behind the receiver, in the same way as from
// points of a light: a channel of the visibility.
// CPU reference: tests/reference/src/reflection.rs.

//#import common/globals
//#import common/reflectance

// Reflected light for a camera in anchor space, the plane space of the first receiver. `part` is
// the visible share of the toy's image.
fn reflected_to(camera: vec3f, point: ReceiverPoint, visibility: vec4f, part: f32) -> vec3f {
  if receiver_of(point) != 0u || all(globals.reflection_channel == vec4f(0.0)) { return vec3f(0.0); }
  let to_camera = normalize(camera - vec3f(point.x, 0.0, point.y));
  let hidden = part * dot(globals.reflection_channel, 1.0 - visibility);
  let light = globals.reflected_surroundings.rgb + hidden * globals.reflected_toy.rgb;
  return even_reflectance(to_camera.y, globals.reflected_surroundings.a) * light;
}

// Reflected light at a point with these visibilities of a pose.
fn reflected(point: ReceiverPoint, visibility: vec4f) -> vec3f {
  return reflected_to(globals.camera_in_anchor, point, visibility, 1.0);
}
