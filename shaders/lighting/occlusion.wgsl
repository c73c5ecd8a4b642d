// Shadows of the posed toy on the receivers, from many points of each light in one pass.
//
// Each instance flattens the mesh from one light point onto one receiver and draws it in the
// camera's view, so a contact edge is as sharp as the screen. Each point is drawn for its own
// position within the pixel, so that a hard edge has as many steps as a soft one; blending
// subtracts its share from the light's visibility.
// Overlapping triangles of one point must not count twice: each point has a constant depth, above
// those before it and all of the lights before, and the depth test rejects fragments that are not
// above the stored depth. It uses no depth of the scene, hence no bias, and there is no acne. A
// pixel shows one receiver, so that all of them share the target: before each is drawn, `fs_route`
// masks pixels that show another by depth.
// All points are equal away from silhouettes: there the toy is drawn only once, while tiles near a
// silhouette are closed (`geometry/silhouette.rs`).
// Each triangle is drawn once per point, from either side; for a closed mesh only those that face
// the light, since a ray that enters it leaves it again.
//
// Reads: posed positions in anchor space; for the ambient light of upright receivers, the lights'
// visibility. Writes: visibility in [0, 1], in the light's channel.
// CPU reference: tests/reference/src/occlusion.rs. Source: Heckbert and Herf 1997 (accumulated
// projections). Here the blending of one pass accumulates, and not one pass per point.

//#import common/flatten
//#import common/fullscreen
//#import common/plate_light
//#import common/position_steps
//#import common/spread
//#import common/tiles

struct LightPoints {
  // Homogeneous: (position, 1) or (unit direction, 0); point k in the space of receiver r has index r n_points + k.
  points: array<vec4f, 256>,
  // Share of each hidden point in the visibility, in the light's channel; all shares together are
  // at least 1.
  share: vec4f,
  // Size of a target's texel in region pixels.
  texel_px: vec2f,
  n_points: u32,
  // Number of points that the lights before it in the map may have.
  n_before: u32,
}

// Maximum number of points of all lights.
const MOST_POINTS: u32 = 256u;

@group(1) @binding(0) var<uniform> light_points: LightPoints;
// The lights' visibilities in the same pose.
@group(1) @binding(1) var shadows: texture_2d<f32>;

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

// Depth below all points if the pixel shows the receiver, and above them if it does not.
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

// Position for which a point is drawn, from the top left corner of a texel, in texels. In a soft
// picture it may be outside the texel; coarser maps contain nothing as sharp as the picture.
fn position_in_texel(point: u32) -> vec2f {
  let lattice = (vec2f(point * POSITION_STEPS % light_points.n_points) + 0.5) / f32(light_points.n_points);
  if is_soft() && all(light_points.texel_px == vec2f(1.0)) { return 0.5 + spread_position_px(lattice); }
  return lattice;
}

fn in_plane_of(instance: u32, in_anchor: vec3f) -> vec3f {
  let receiver = instance / light_points.n_points;
  return (globals.receivers[receiver].plane_from_anchor * vec4f(in_anchor, 1.0)).xyz;
}

// Clip position of a point's shadow, moved so that its light point's position comes to the pixel's
// centre, where the rasteriser samples.
fn moved_clip(instance: u32, in_plane: vec3f) -> vec4f {
  let receiver = instance / light_points.n_points;
  let clip = clip_from_flattened(receiver, flatten(light_points.points[instance], in_plane));
  let to_centre_px = (0.5 - position_in_texel(instance % light_points.n_points)) * light_points.texel_px;
  return clip + vec4f(clip.w * vec2f(2.0, -2.0) * to_centre_px / globals.region_size_px, 0.0, 0.0);
}

// Depth of a rank among all lights' points, from 1 on, in (0, 1). Fractional ranks lie between
// points.
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

// Shadows that are fully in front of the camera, of a toy below the light: nothing is clipped by
// depth, so the fragment shader need not write it.
@vertex
fn vs_plain(@location(0) in_anchor: vec3f, @builtin(instance_index) instance: u32) -> Plain {
  let in_plane = in_plane_of(instance, in_anchor);
  let clip = moved_clip(instance, in_plane);
  return Plain(vec4f(clip.xy, clip.w * depth_of(instance), clip.w), in_plane.y);
}

// A depth above all points, so that none counts again. It is only used for shadows that are fully
// in front of the camera, of a toy below the light.
@vertex
fn vs_once(@location(0) in_anchor: vec3f, @builtin(instance_index) instance: u32) -> @builtin(position) vec4f {
  let receiver = instance / light_points.n_points;
  let clip =
    clip_from_flattened(receiver, flatten(light_points.points[instance], in_plane_of(instance, in_anchor)));
  // Whole and quarter ranks avoid halves of the 65,535 steps of depth, whose rounding is not
  // defined.
  return vec4f(clip.xy, clip.w * depth_of_rank(f32(light_points.n_points) + 0.25), clip.w);
}

// All points of a light, in a pixel away from the shadow's silhouettes.
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
  // Parts under the receiver cast no shadow on it: their depth is not above that of any point.
  return Hidden(light_points.share, select(0.0, depth, height_m >= 0.0));
}

// Part of the light from a place of a receiver that all lights together give it, before any
// fit; a part of what is taken returns by the toy's bounce. After a blur, the shadow's error is .94
// codes with 0, and .66, .64, .62 and .61 with .6, .7, .8 and 1 beside a book whose lit table lights
// its side; 1.22, and 1.09, 1.07, 1.06 and 1.05 beside a box; and .95, and .84, .83, .83 and .83
// before a wall.
const LIT_PART: f32 = 0.8;

// The nearest place of a receiver that is seen along a way through anchor space.
fn place_on_way(origin: vec3f, direction: vec3f) -> ReceiverPoint {
  var nearest = NO_RECEIVER;
  var inverse_distance = 0.0;
  for (var k = 0u; k < globals.n_receivers; k++) {
    let plane_from_anchor = globals.receivers[k].plane_from_anchor;
    let here = (plane_from_anchor * vec4f(origin, 1.0)).xyz;
    let along = (plane_from_anchor * vec4f(direction, 0.0)).xyz;
    if here.y <= 0.0 || -along.y <= inverse_distance * here.y { continue; }
    let in_plane = here.xz - here.y / along.y * along.xz;
    if is_within(globals.receivers[k].rect, in_plane) {
      nearest = point_on(k, in_plane);
      inverse_distance = -along.y / here.y;
    }
  }
  return nearest;
}

// Part of the light of a place that the toy's shadows take; 0 if the camera does not see the place.
fn taken_from(place: ReceiverPoint) -> f32 {
  let texel = floor(region_px_of(place));
  if any(texel < vec2f(0.0)) || any(texel >= globals.region_size_px) { return 0.0; }
  if receiver_of(receiver_point(texel + 0.5)) != receiver_of(place) { return 0.0; }
  let hidden = 1.0 - textureLoad(shadows, vec2i(texel), 0);
  var taken = 0.0;
  var n_above = 0.0;
  for (var i = 0u; i < globals.n_lights; i++) {
    if hidden[i] > 0.0 { taken += hidden[i] * falloff(i, place); }
    n_above += select(0.0, 1.0, globals.receivers[receiver_of(place)].lights[i].y > 0.0);
  }
  return LIT_PART * taken / max(n_above, 1.0);
}

// The ambient light of an upright receiver, such as a wall or the side of a book. It sees others,
// above all the one below it, and where these are in the toy's shadow, a part of their light is
// missing. The toy hides directions to shadows and to others alike: it takes the same part of both.
@fragment
fn fs_upright(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let point = receiver_point(at.xy * light_points.texel_px);
  let own = receiver_of(point);
  if !is_hit(point) || globals.receivers[own].plane_from_anchor[1].y >= STANDS { return vec4f(1.0); }
  let turn = anchor_turn(own);
  let origin = turn * (vec3f(point.x, 0.0, point.y) - globals.receivers[own].plane_from_anchor[3].xyz);
  var taken = 0.0;
  for (var i = 0u; i < light_points.n_points; i++) {
    let place = place_on_way(origin, turn * light_points.points[own * light_points.n_points + i].xyz);
    if is_hit(place) { taken += taken_from(place); }
  }
  return vec4f(max(1.0 - taken / f32(light_points.n_points), 0.0));
}
