// The real shadow warped to the animated pose: for each texel of the new shadow, where in the frame its vertex's real
// shadow lies.
//
// The animated mesh, flattened from the light, is the geometry; the flattened physical mesh gives the texture
// coordinates. Where several parts of the toy shade one texel the one closest to the light stays.
//
// Reads: positions of both poses. Writes: source in region_px, occluder's height in metres, 1.
// Source: Casas et al. 2018, sections 3.2 and 4.5.

struct Warped {
  @builtin(position) clip: vec4f,
  // Homogeneous, so that the division comes after the interpolation.
  @location(0) source: vec3f,
  @location(1) height_m: f32,
}

@vertex
fn vs_warp(@location(0) shown_in_plane: vec3f, @location(1) physical_in_plane: vec3f) -> Warped {
  let source = globals.receivers[0].clip_from_plane * flatten(published.light, physical_in_plane);
  return Warped(clip_from_flattened(0u, flatten(published.light, shown_in_plane)), source, shown_in_plane.y);
}

struct WarpTexel {
  @location(0) source: vec4f,
  @builtin(frag_depth) to_light: f32,
}

@fragment
fn fs_source(in: Warped) -> WarpTexel {
  if in.height_m < 0.0 || in.source.z <= 0.0 { discard; }
  let ndc = in.source.xy / in.source.z;
  let region_px = (ndc * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
  // Heights below a light map to (0, 1], the light itself to 1: the highest occluder wins under `Greater`.
  let reach_m = select(1.0, published.light.y, published.light.w > 0.0);
  return WarpTexel(vec4f(region_px, in.height_m, 1.0), saturate(in.height_m / reach_m));
}
