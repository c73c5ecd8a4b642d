// Points of the physical toy from their depth.

//#import common/globals

// The visible point at a pixel: on its ray, at its depth. The plane of the first receiver is y = 0
// in anchor space.
fn seen_in_anchor(at: vec2f, depth: f32) -> vec3f {
  let depth_m = globals.clip_from_anchor[3].z / depth;
  let on_plane = globals.receivers[0].plane_from_region_px * vec3f(at, 1.0);
  let ray = vec3f(on_plane.x, 0.0, on_plane.y) - globals.camera_in_anchor * on_plane.z;
  return globals.camera_in_anchor + depth_m * ray;
}
