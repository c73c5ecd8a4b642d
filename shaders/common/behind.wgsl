// Whether a receiver hides the toy: for example a foot that sinks into the table, or a tail behind
// a wall.

//#import common/globals

// Relative difference of depth up to which a surface counts as on the receiver, not behind it.
const ON_RECEIVER: f32 = 1e-4;

// Point of the first receiver's plane that is visible at a point: the plane's (x, z, w) over the
// point's inverse depth. It is linear in the point, so that it can be computed at corners and
// interpolated.
fn on_first_receiver(clip: vec4f) -> vec3f {
  let at = (clip.xy * vec2f(0.5, -0.5) + 0.5 * clip.w) * globals.region_size_px;
  return globals.receivers[0].plane_from_region_px * vec3f(at, clip.w);
}

// Whether the first receiver is in front of such a point.
fn is_behind_first(on_receiver: vec3f) -> bool {
  return on_receiver.z * (1.0 - ON_RECEIVER) > 1.0
    && is_within(on_receiver.z * globals.receivers[0].rect, on_receiver.xy);
}

// Whether a receiver is in front of a point at `region_px` with this inverse depth (1 / m).
fn is_behind_receiver(region_px: vec2f, inverse_depth: f32) -> bool {
  for (var k = 0u; k < globals.n_receivers; k++) {
    let p = globals.receivers[k].plane_from_region_px * vec3f(region_px, 1.0);
    if p.z * (1.0 - ON_RECEIVER) <= inverse_depth { continue; }
    if is_within(p.z * globals.receivers[k].rect, p.xy) { return true; }
  }
  return false;
}
