// Uniforms shared by all passes: the work region of the camera image, the receivers, the lights.
//
// Spaces: `region_px`, pixels of the work region, origin top left, pixel centres at .5;
// `anchor`, metres, where the toy is posed: the plane space of the first receiver;
// `plane`, metres in a receiver's own frame, whose normal is +Y; a point of the receiver is (x, z).

const MAX_LIGHTS: u32 = 4u;
const MAX_RECEIVERS: u32 = 4u;
const MAX_FRONTS: u32 = 2u;

struct ReceiverPlane {
  plane_from_anchor: mat4x4f,
  // Homography: (x, z, w) of the plane's point seen at (u, v, 1); w is 1 / depth, negative behind the camera.
  plane_from_region_px: mat3x3f,
  // Homography: clip (x, y, w) of the plane's point (x, z, 1); w is the depth in metres.
  clip_from_plane: mat3x3f,
  // The scene's lights in this plane's space, homogeneous: (position, 1) or (unit direction to the light, 0).
  lights: array<vec4f, MAX_LIGHTS>,
  // Point at which the lights' shares are stated: the nearest one to the toy.
  reference_in_plane: vec2f,
  _pad: vec2f,
  // Bounds of the receiver: smallest x and z, then largest.
  rect: vec4f,
  // 1 for each receiver above which the middle of this one is.
  stands_on: vec4f,
}

struct Globals {
  // Clip space of the region; depth is reversed: 1 at the near plane, 0 at infinity.
  clip_from_anchor: mat4x4f,
  receivers: array<ReceiverPlane, MAX_RECEIVERS>,
  // The lights in anchor space.
  lights: array<vec4f, MAX_LIGHTS>,
  // Radius of each light's disc: metres for a sphere, slope for a directional light.
  light_radii: vec4f,
  // Width of the fade into untouched pixels at the region's (left, top, right, bottom) edge; 0 at the image's own edge.
  border_px: vec4f,
  camera_in_anchor: vec3f,
  n_lights: u32,
  region_size_px: vec2f,
  // Top left corner of the region in the camera image.
  region_origin_px: vec2f,
  // The part of the region that the toy's targets cover: its corner, counted from the region's, and
  // its size.
  toy_box_origin_px: vec2f,
  toy_box_size_px: vec2f,
  // The same for the part that the physical toy's maps cover.
  physical_box_origin_px: vec2f,
  physical_box_size_px: vec2f,
  // Spread of a point in a softer picture, including the pixel itself: its principal axes, the wider
  // first, each as long as the standard deviation along it, in pixels. 0 for a sharp picture.
  spread: vec4f,
  n_receivers: u32,
  // Bit k is 1 if receiver k is seen from behind.
  seen_from_behind: u32,
  // Depth in metres below which a shadow is clipped: a small part of the distance to the toy.
  near_m: f32,
  // Weight of the neighbours on either side, along each axis, in means over spread positions;
  // `spread` does not include their spread.
  soft_side: f32,
  // Largest distance of a position of the spread from the pixel's centre; 0 for a sharp picture.
  soft_reach_px: f32,
  // 1 if the spread is uniform along its wider axis, as by a motion, and not normal.
  is_line: u32,
  _pad_0: vec2f,
  // Normals and offsets in metres of the planes in anchor space before which the toy is drawn over the things before
  // it; 0 in place of none.
  things_fronts: array<vec4f, MAX_FRONTS>,
  // 1 in the channel of the visibilities with the unhidden part of the first receiver's reflection;
  // 0 if the receiver is matt.
  reflection_channel: vec4f,
  // Reflected light of the surroundings, at the plate's exposure; the square root of its lobe's
  // width.
  reflected_surroundings: vec4f,
  // The toy's light less that of the surroundings; negative if the toy is darker.
  reflected_toy: vec4f,
}

@group(0) @binding(0) var<uniform> globals: Globals;

fn has_no_light() -> bool {
  return globals.n_lights == 0u;
}

// The texel of the toy box at a texel of the region, which exists if `is_in_toy_box`.
fn box_texel(in_region: vec2i) -> vec2i {
  return in_region - vec2i(globals.toy_box_origin_px);
}

fn is_in_toy_box(in_box: vec2i) -> bool {
  return all(in_box >= vec2i(0)) && all(in_box < vec2i(globals.toy_box_size_px));
}

// The texel of the box nearest to one that may lie outside.
fn clamped_to_box(in_box: vec2i) -> vec2i {
  return clamp(in_box, vec2i(0), vec2i(globals.toy_box_size_px) - 1);
}

// The same for the physical box.
fn physical_texel(in_region: vec2i) -> vec2i {
  return in_region - vec2i(globals.physical_box_origin_px);
}

fn is_in_physical_box(in_box: vec2i) -> bool {
  return all(in_box >= vec2i(0)) && all(in_box < vec2i(globals.physical_box_size_px));
}

fn clamped_to_physical_box(in_box: vec2i) -> vec2i {
  return clamp(in_box, vec2i(0), vec2i(globals.physical_box_size_px) - 1);
}

// The texel of the region at a texel of the physical box.
fn region_texel(in_box: vec2i) -> vec2i {
  return in_box + vec2i(globals.physical_box_origin_px);
}

// A point of a receiver: (x, z) in its plane, and its index, which is MAX_RECEIVERS if the pixel
// shows none. It is a vector, since drivers of older Adreno keep structs in fragment shaders at 16
// bits. Source: KhronosGroup/WebGL issue 3351.
alias ReceiverPoint = vec3f;

const NO_RECEIVER = vec3f(0.0, 0.0, f32(MAX_RECEIVERS));

fn point_on(receiver: u32, in_plane: vec2f) -> ReceiverPoint {
  return vec3f(in_plane, f32(receiver));
}

fn receiver_of(point: ReceiverPoint) -> u32 {
  return u32(point.z);
}

fn is_within(rect: vec4f, in_plane: vec2f) -> bool {
  return all(in_plane >= rect.xy) && all(in_plane <= rect.zw);
}

// The nearest receiver at a pixel, seen from either side.
fn surface_point(region_px: vec2f) -> ReceiverPoint {
  var nearest = NO_RECEIVER;
  var inverse_depth = 0.0;
  for (var k = 0u; k < globals.n_receivers; k++) {
    let p = globals.receivers[k].plane_from_region_px * vec3f(region_px, 1.0);
    if p.z <= inverse_depth { continue; }
    let in_plane = p.xy / p.z;
    if is_within(globals.receivers[k].rect, in_plane) {
      nearest = point_on(k, in_plane);
      inverse_depth = p.z;
    }
  }
  return nearest;
}

// The same for the front alone: the light on the back is unknown.
fn receiver_point(region_px: vec2f) -> ReceiverPoint {
  let nearest = surface_point(region_px);
  if ((globals.seen_from_behind >> receiver_of(nearest)) & 1u) != 0u { return NO_RECEIVER; }
  return nearest;
}

fn is_hit(point: ReceiverPoint) -> bool {
  return receiver_of(point) < MAX_RECEIVERS;
}

// Position of a receiver's point in the region; outside the region if it is behind the camera.
fn region_px_of(point: ReceiverPoint) -> vec2f {
  let at = globals.receivers[receiver_of(point)].clip_from_plane * vec3f(point.xy, 1.0);
  if at.z <= 0.0 { return vec2f(-1.0); }
  return (at.xy / at.z * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
}
