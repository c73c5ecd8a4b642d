// Moved mask: the parts in which the visible surface of the real toy has moved in the shown pose.
//
// Reads: both poses. Writes: 1 if the surface has moved, as a fraction of the pixel.

//#import common/moved
//#import common/behind

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) shown_clip: vec4f,
  @location(1) physical_clip: vec4f,
}

@vertex
fn vs_physical(@location(0) physical_in_anchor: vec3f, @location(1) in_anchor: vec3f) -> Surface {
  let shown = globals.clip_from_anchor * vec4f(in_anchor, 1.0);
  let physical = globals.clip_from_anchor * vec4f(physical_in_anchor, 1.0);
  return Surface(physical, shown, physical);
}

@fragment
fn fs_moved(
  @builtin(position) at: vec4f,
  @location(0) shown_clip: vec4f,
  @location(1) physical_clip: vec4f,
) -> @location(0) vec4f {
  // Nothing is discarded, so that depth is tested first: surfaces behind this one are behind the
  // receiver, too.
  if is_behind_receiver(at.xy + globals.toy_box_origin_px, at.w) { return vec4f(0.0); }
  return vec4f(moved(region_px(shown_clip), region_px(physical_clip)));
}
