// Whether a receiver hides the toy: a foot that sinks into the table, a tail behind a wall.

// Share of the depth within which a surface lies on the receiver, not behind it.
const ON_RECEIVER: f32 = 1e-4;

// Whether a receiver is seen at `region_px` before a point there, which has this inverse depth (1 / m).
fn is_behind_receiver(region_px: vec2f, inverse_depth: f32) -> bool {
  for (var k = 0u; k < globals.n_receivers; k++) {
    let p = globals.receivers[k].plane_from_region_px * vec3f(region_px, 1.0);
    if p.z * (1.0 - ON_RECEIVER) <= inverse_depth { continue; }
    if is_within(p.z * globals.receivers[k].rect, p.xy) { return true; }
  }
  return false;
}
