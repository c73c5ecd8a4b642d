// Shadows of the posed toy on the receivers, from many points of each light in one pass.
//
// Each instance flattens the mesh from one light point onto one receiver and draws it where the camera sees it, so a
// contact edge is as sharp as the screen. Each point is drawn for its own position within the pixel, so that a hard edge has
// as many steps as a soft one; blending takes its share from the light's visibility.
// Overlapping triangles of one point must not count twice: each point has a constant depth, above those before it and all of
// the lights before, and the depth test rejects what is not above the stored depth. No depth of the scene, hence no bias and no acne.
// A pixel shows one receiver, so that all of them share the target: before each is drawn, `fs_route` masks pixels
// that show another by depth.
// Where no silhouette comes near all points see the same: there the toy is drawn but once, and tiles that a silhouette does come
// near are closed meanwhile (`geometry/silhouette.rs`).
// Each triangle is drawn once a point, from whichever side; of a closed mesh only those that face the light: a ray that
// enters it leaves it again.
//
// Reads: posed positions in anchor space. Writes: visibility in [0, 1], in the light's channel.
// CPU reference: tests/reference/src/occlusion.rs. Source: Heckbert and Herf 1997 (accumulated projections).
// Here the accumulation is done by the blending of one pass rather than by one pass per point.

//#import common/flatten
//#import common/spread
//#import common/tiles

struct LightPoints {
  // Homogeneous: (position, 1) or (unit direction, 0); point k in the space of receiver r has index r n_points + k.
  points: array<vec4f, 256>,
  // What each hidden point takes from the visibility, in the light's channel; of all of them at least 1.
  share: vec4f,
  // Size of a target's texel in region pixels.
  texel_px: vec2f,
  n_points: u32,
  // Points that the lights before it in the map may have.
  n_before: u32,
}

// Points that all lights may have.
const MOST_POINTS: u32 = 256u;

// Column and row step from one point's position within a pixel to the next one's: each point is in a row and a column of
// its own, and neighbours on the light are far apart. Of all odd steps these have the least RMS error of the part that a
// straight edge of any direction hides, with 64 points over discs of 0, 1/4 and 1 pixel radius: .011, .016 and .016, where
// four positions have .084, .027 and .022.
const POSITION_STEPS = vec2u(47u, 53u);

@group(1) @binding(0) var<uniform> light_points: LightPoints;

struct Routed {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, either) receiver: u32,
}

// Full-screen triangle, one instance per receiver.
@vertex
fn vs_route(@builtin(vertex_index) index: u32, @builtin(instance_index) receiver: u32) -> Routed {
  let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
  return Routed(vec4f(corner * 2.0 - 1.0, 0.0, 1.0), receiver);
}

// Depth below all points where the pixel shows the receiver, above them where it does not.
@fragment
fn fs_route(
  @builtin(position) at: vec4f,
  @location(0) @interpolate(flat, either) receiver: u32,
) -> @builtin(frag_depth) f32 {
  return select(1.0, 0.0, receiver_of(receiver_point(at.xy * light_points.texel_px)) == receiver);
}

struct Flattened {
  @builtin(position) clip: vec4f,
  @location(0) height_m: f32,
  @location(1) @interpolate(flat, either) depth: f32,
}

// Where a point is drawn for, from the top left corner of a texel, in texels. In a soft picture that is also beside the texel;
// coarser maps have nothing that is as sharp as the picture.
fn position_in_texel(point: u32) -> vec2f {
  let lattice = (vec2f(point * POSITION_STEPS % light_points.n_points) + 0.5) / f32(light_points.n_points);
  if is_soft() && all(light_points.texel_px == vec2f(1.0)) { return 0.5 + spread_position_px(lattice); }
  return lattice;
}

fn in_plane_of(instance: u32, in_anchor: vec3f) -> vec3f {
  let receiver = instance / light_points.n_points;
  return (globals.receivers[receiver].plane_from_anchor * vec4f(in_anchor, 1.0)).xyz;
}

// Where the shadow of a point is drawn, moved so that its light point's position comes to the pixel's centre, where the
// rasteriser samples.
fn moved_clip(instance: u32, in_plane: vec3f) -> vec4f {
  let receiver = instance / light_points.n_points;
  let clip = clip_from_flattened(receiver, flatten(light_points.points[instance], in_plane));
  let to_centre_px = (0.5 - position_in_texel(instance % light_points.n_points)) * light_points.texel_px;
  return clip + vec4f(clip.w * vec2f(2.0, -2.0) * to_centre_px / globals.region_size_px, 0.0, 0.0);
}

// Depth of a rank among all lights' points, from 1 on, in (0, 1). Ranks that are no whole number lie between points.
fn depth_of_rank(rank: f32) -> f32 {
  return (f32(light_points.n_before) + rank) / f32(MOST_POINTS + 1u);
}

fn depth_of(instance: u32) -> f32 {
  return depth_of_rank(f32(instance % light_points.n_points + 1u));
}

@vertex
fn vs_flatten(@location(0) in_anchor: vec3f, @builtin(instance_index) instance: u32) -> Flattened {
  let in_plane = in_plane_of(instance, in_anchor);
  return Flattened(moved_clip(instance, in_plane), in_plane.y, depth_of(instance));
}

struct Plain {
  @builtin(position) clip: vec4f,
  @location(0) height_m: f32,
}

// Where all of the shadow is in front of the camera, and the toy below the light: nothing is cut off by depth, which then
// needs not to be written by the fragment shader.
@vertex
fn vs_plain(@location(0) in_anchor: vec3f, @builtin(instance_index) instance: u32) -> Plain {
  let in_plane = in_plane_of(instance, in_anchor);
  let clip = moved_clip(instance, in_plane);
  return Plain(vec4f(clip.xy, clip.w * depth_of(instance), clip.w), in_plane.y);
}

// Above all points, so that none counts again. Only drawn where all of the shadow is in front of the camera, and the toy
// below the light.
@vertex
fn vs_once(@location(0) in_anchor: vec3f, @builtin(instance_index) instance: u32) -> @builtin(position) vec4f {
  let receiver = instance / light_points.n_points;
  let clip =
    clip_from_flattened(receiver, flatten(light_points.points[instance], in_plane_of(instance, in_anchor)));
  // Whole and quarter ranks are no halves of the 65,535 steps of depth, which might be rounded either way.
  return vec4f(clip.xy, clip.w * depth_of_rank(f32(light_points.n_points) + 0.25), clip.w);
}

// All points of a light, in a pixel that no silhouette of a shadow comes near.
@fragment
fn fs_cover_all() -> @location(0) vec4f {
  return f32(light_points.n_points) * light_points.share;
}

struct Hidden {
  @location(0) share: vec4f,
  @builtin(frag_depth) depth: f32,
}

// Parts under the receiver cast no shadow on it.
@fragment
fn fs_cover_plain(@location(0) height_m: f32) -> @location(0) vec4f {
  if height_m < 0.0 { discard; }
  return light_points.share;
}

@fragment
fn fs_cover(@location(0) height_m: f32, @location(1) @interpolate(flat, either) depth: f32) -> Hidden {
  // Parts under the receiver cast no shadow on it: their depth is above no point's.
  return Hidden(light_points.share, select(0.0, depth, height_m >= 0.0));
}
