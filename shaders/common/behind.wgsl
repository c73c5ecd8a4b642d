// Whether a receiver hides the toy: a foot that sinks into the table, a tail behind a wall.

//#import common/globals

// Share of the depth within which a surface lies on the receiver, not behind it.
const ON_RECEIVER: f32 = 1e-4;

// Where the plane of the first receiver is seen at a point: as the plane's (x, z, w) over the point's inverse depth, linear
// in the point, so that it may be told of corners and interpolated.
fn on_first_receiver(clip: vec4f) -> vec3f {
  let at = (clip.xy * vec2f(0.5, -0.5) + 0.5 * clip.w) * globals.region_size_px;
  return globals.receivers[0].plane_from_region_px * vec3f(at, clip.w);
}

// Whether the first receiver is seen before such a point.
fn is_behind_first(on_receiver: vec3f) -> bool {
  return on_receiver.z * (1.0 - ON_RECEIVER) > 1.0
    && is_within(on_receiver.z * globals.receivers[0].rect, on_receiver.xy);
}

// Whether a receiver is seen at `region_px` before a point there, which has this inverse depth (1 / m).
fn is_behind_receiver(region_px: vec2f, inverse_depth: f32) -> bool {
  for (var k = 0u; k < globals.n_receivers; k++) {
    let p = globals.receivers[k].plane_from_region_px * vec3f(region_px, 1.0);
    if p.z * (1.0 - ON_RECEIVER) <= inverse_depth { continue; }
    if is_within(p.z * globals.receivers[k].rect, p.xy) { return true; }
  }
  return false;
}
