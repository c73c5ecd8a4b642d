// The real shadow of one light warped to the animated pose: for each texel of the new shadow, the
// position in the frame of its vertex's real shadow.
//
// The animated mesh, flattened from the light, is the geometry; the flattened physical mesh gives
// the texture coordinates. If several parts of the toy overlap in a texel, the one closest to the
// light is kept. Each receiver has its own shadow, cut off at the next receiver.
//
// Reads: positions of both poses. Writes: source in region_px, occluder's height over the receiver
// in metres, 1.
// Source: Casas et al. 2018, sections 3.2 and 4.5; 2019, section 5.7.

//#import common/baseline
//#import common/flatten

struct Warped {
  @builtin(position) clip: vec4f,
  // Homogeneous, so that the division comes after the interpolation.
  @location(0) source: vec3f,
  @location(1) height_m: f32,
  @location(2) @interpolate(flat) light: u32,
  @location(3) @interpolate(flat) receiver: u32,
}

@vertex
fn vs_warp(
  @location(0) shown_in_anchor: vec3f,
  @location(1) physical_in_anchor: vec3f,
  @builtin(instance_index) instance: u32,
) -> Warped {
  let light = instance / MAX_RECEIVERS;
  let receiver = instance % MAX_RECEIVERS;
  let plane_from_anchor = globals.receivers[receiver].plane_from_anchor;
  let shown = (plane_from_anchor * vec4f(shown_in_anchor, 1.0)).xyz;
  let physical = (plane_from_anchor * vec4f(physical_in_anchor, 1.0)).xyz;
  let at = globals.receivers[receiver].lights[light];
  let clip = clip_from_flattened(receiver, flatten(at, shown));
  let source = globals.receivers[receiver].clip_from_plane * flatten(at, physical);
  return Warped(clip, source, shown.y, light, receiver);
}

struct WarpTexel {
  @location(0) source: vec4f,
  @builtin(frag_depth) to_light: f32,
}

@fragment
fn fs_source(
  @builtin(position) at: vec4f,
  @location(0) source: vec3f,
  @location(1) height_m: f32,
  @location(2) @interpolate(flat) light: u32,
  @location(3) @interpolate(flat) receiver: u32,
) -> WarpTexel {
  if height_m < 0.0 || receiver_at(vec2i(at.xy)) != receiver { discard; }
  // A vertex whose real shadow is behind the camera samples at the texel of its new one.
  var region_px = at.xy;
  if source.z > 0.0 {
    let ndc = source.xy / source.z;
    region_px = (ndc * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
  }
  // Heights below a light map to (0, 1], the light itself to 1: the highest occluder wins under `Greater`.
  let light_in_plane = globals.receivers[receiver].lights[light];
  let reach_m = select(1.0, light_in_plane.y, light_in_plane.w > 0.0);
  return WarpTexel(vec4f(region_px, height_m, 1.0), saturate(height_m / reach_m));
}
