// Tiles of a counting target, which are closed to later draws, or opened again.

//#import common/globals

@vertex
fn vs_tile(@location(0) in_region_px: vec3f, @builtin(instance_index) is_closed: u32) -> @builtin(position) vec4f {
  let at = in_region_px.xy / globals.region_size_px * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
  // Nothing passes a depth of 1.
  return vec4f(at, f32(is_closed), 1.0);
}

@fragment
fn fs_tile() {}
