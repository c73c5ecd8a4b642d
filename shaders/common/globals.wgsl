// What every pass knows of the scene: the region of the camera image we work in, the receiver's plane, the lights.
//
// Spaces: `region_px`, pixels of the work region, origin top left, pixel centres at .5;
// `plane`, metres in the receiver's own frame, whose normal is +Y; a point of the receiver is (x, z).

const MAX_LIGHTS: u32 = 4u;

struct Globals {
  // Clip space of the region; depth is reversed: 1 at the near plane, 0 at infinity.
  clip_from_stage: mat4x4f,
  // Homography: (x, z, w) of the receiver point seen at (u, v, 1); w > 0 in front of the camera.
  plane_from_region_px: mat3x3f,
  // Homography: clip (x, y, w) of the receiver point (x, z, 1); w is the depth in metres.
  clip_from_receiver: mat3x3f,
  // Homogeneous: (position, 1) or (unit direction to the light, 0), in plane space.
  lights: array<vec4f, MAX_LIGHTS>,
  // Width of the fade into untouched pixels at the region's (left, top, right, bottom) edge; 0 at the image's own edge.
  border_px: vec4f,
  camera_in_stage: vec3f,
  n_lights: u32,
  // Where the lights' shares are stated: the receiver under the toy.
  reference_in_plane: vec2f,
  half_extent_m: vec2f,
  region_size_px: vec2f,
  // Top left corner of the region in the camera image.
  region_origin_px: vec2f,
}

@group(0) @binding(0) var<uniform> globals: Globals;

struct ReceiverPoint {
  in_plane: vec2f,
  // False where the pixel does not see the receiver.
  is_hit: bool,
}

fn receiver_point(region_px: vec2f) -> ReceiverPoint {
  let p = globals.plane_from_region_px * vec3f(region_px, 1.0);
  if p.z <= 0.0 { return ReceiverPoint(vec2f(0.0), false); }
  let in_plane = p.xy / p.z;
  return ReceiverPoint(in_plane, all(abs(in_plane) <= globals.half_extent_m));
}

// Irradiance of light `i` at a receiver point as a multiple of that at the reference point: cos / d^2, where the
// cosine is height over distance.
fn falloff(i: u32, in_plane: vec2f) -> f32 {
  let light = globals.lights[i];
  if light.w == 0.0 { return 1.0; }
  let to_here = distance(light.xyz, vec3f(in_plane.x, 0.0, in_plane.y));
  let to_reference = distance(light.xyz, vec3f(globals.reference_in_plane.x, 0.0, globals.reference_in_plane.y));
  let ratio = to_reference / to_here;
  return ratio * ratio * ratio;
}
