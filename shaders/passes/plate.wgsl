// The plate for this camera: the place without the toy, from plates of this or other cameras.
//
// Plates are warped to this view by the homographies of the receivers. Each point comes from the
// plate that shows it best, from a similar direction and in no less detail, with soft seams; each
// plate has its exposure.
//
// The first receiver's reflection of its surroundings is subtracted, for the view of each camera: a
// shadow does not change it.
//
// Reads: plates. Writes: linear colour, alpha is 1 if a plate shows the point.
// CPU reference: tests/reference/src/plate.rs.
// Source: Casas et al. 2019, section 5.8, keeps one plate for a moving camera; here the best of
// several.

//#import common/globals
//#import common/reflection
//#import common/fullscreen

const MAX_PLATES: u32 = 4u;

struct PlateView {
  // Homographies: (u, v, w) in the plate's pixels of a receiver's point (x, z, 1), w > 0 in front of its camera.
  plate_px_from_plane: array<mat3x3f, MAX_RECEIVERS>,
  // The plate's camera in each receiver's space.
  camera_in_plane: array<vec4f, MAX_RECEIVERS>,
  // Factor from the plate's exposure to that of the first one.
  gain: vec4f,
}

struct PlateViews {
  plates: array<PlateView, MAX_PLATES>,
  // This camera in each receiver's space.
  camera_in_plane: array<vec4f, MAX_RECEIVERS>,
  n_plates: u32,
  _pad_0: u32,
  _pad_1: vec2u,
}

@group(1) @binding(0) var<uniform> views: PlateViews;
@group(1) @binding(1) var plates: texture_2d_array<f32>;

// Distance from a plate's border over which it is blended with another.
const FEATHER_PX: f32 = 32.0;
// Cosine below which a plate's quality no longer falls with the angle: it may be the only one.
const LEAST_COSINE: f32 = 0.1;
// Weight relative to the best below which a plate is ignored.
const LEAST_WEIGHT: f32 = 0.02;

// The fourth power: the quality of a plate for the cosine of its view's angle.
fn angle_quality(cosine: f32) -> f32 {
  let square = cosine * cosine;
  return square * square;
}

// The sixth power of the quality: high, since a mix of two plates is blurred.
fn choice_weight(quality: f32) -> f32 {
  let square = quality * quality;
  return square * square * square;
}

// A plate's view of a point: xy is its position in pixels; z the quality, positive if it is
// visible; w is 1 well inside the plate and 0 at its border.
alias Candidate = vec4f;

const UNSEEN = vec4f(0.0);

fn direction_to(camera: vec4f, in_plane: vec2f) -> vec3f {
  return normalize(camera.xyz - vec3f(in_plane.x, 0.0, in_plane.y));
}

// Position of a receiver's point in the space of another receiver.
fn in_other_plane(point: ReceiverPoint, other: u32) -> vec3f {
  let own_from_anchor = globals.receivers[receiver_of(point)].plane_from_anchor;
  let rotation = mat3x3f(own_from_anchor[0].xyz, own_from_anchor[1].xyz, own_from_anchor[2].xyz);
  let in_anchor = transpose(rotation) * (vec3f(point.xy.x, 0.0, point.xy.y) - own_from_anchor[3].xyz);
  return (globals.receivers[other].plane_from_anchor * vec4f(in_anchor, 1.0)).xyz;
}

// Whether another receiver stands between plate `k`'s camera and a point.
fn is_hidden(k: u32, point: ReceiverPoint) -> bool {
  for (var other = 0u; other < globals.n_receivers; other++) {
    if other == receiver_of(point) { continue; }
    let camera = views.plates[k].camera_in_plane[other].xyz;
    let end = in_other_plane(point, other);
    if camera.y * end.y >= 0.0 { continue; }
    let crossing = mix(camera.xz, end.xz, camera.y / (camera.y - end.y));
    if is_within(globals.receivers[other].rect, crossing) { return true; }
  }
  return false;
}

// This camera's view of a point: xyz is the direction to it; w the area on the receiver per pixel,
// since a homography of determinant D scales areas by D / w^3.
alias Sight = vec4f;

fn sight_of(point: ReceiverPoint, region_px: vec2f) -> Sight {
  let own = views.camera_in_plane[receiver_of(point)];
  let here = globals.receivers[receiver_of(point)].plane_from_region_px;
  let w = (here * vec3f(region_px, 1.0)).z;
  return vec4f(direction_to(own, point.xy), determinant(here) / (w * w * w));
}

// Number of plate pixels per pixel, by area; less than one loses detail.
fn detail(sight: Sight, plate_px_from_plane: mat3x3f, plate_w: f32) -> f32 {
  return min(abs(sight.w * determinant(plate_px_from_plane) / (plate_w * plate_w * plate_w)), 1.0);
}

// Plate `k`'s view of a point.
fn candidate(k: u32, point: ReceiverPoint, sight: Sight) -> Candidate {
  let plate_px_from_plane = views.plates[k].plate_px_from_plane[receiver_of(point)];
  let at = plate_px_from_plane * vec3f(point.xy, 1.0);
  if at.z <= 0.0 { return UNSEEN; }
  let px = at.xy / at.z;
  let size = vec2f(textureDimensions(plates));
  let to_border = min(px, size - px);
  let inside = saturate(min(to_border.x, to_border.y) / FEATHER_PX);
  let camera = views.plates[k].camera_in_plane[receiver_of(point)];
  let is_same_side = camera.y * sight.y > 0.0;
  if inside == 0.0 || !is_same_side || is_hidden(k, point) { return UNSEEN; }
  let cosine = dot(direction_to(camera, point.xy), sight.xyz);
  return vec4f(px, detail(sight, plate_px_from_plane, at.z) * angle_quality(max(cosine, LEAST_COSINE)), inside);
}

// Weights of four texels around a position `t` past the second. Source: Catmull and Rom 1974.
fn cubic(t: f32) -> vec4f {
  let s = t * t;
  let c = s * t;
  return 0.5 * vec4f(2.0 * s - t - c, 2.0 - 5.0 * s + 3.0 * c, t + 4.0 * s - 3.0 * c, c - s);
}

fn sharp_color(k: u32, px: vec2f) -> vec3f {
  let at = px - 0.5;
  let low = floor(at);
  let wx = cubic(at.x - low.x);
  let wy = cubic(at.y - low.y);
  let last = vec2i(textureDimensions(plates)) - 1;
  var sum = vec3f(0.0);
  for (var j = 0; j < 4; j++) {
    for (var i = 0; i < 4; i++) {
      let texel = clamp(vec2i(low) + vec2i(i - 1, j - 1), vec2i(0), last);
      sum += wx[i] * wy[j] * textureLoad(plates, texel, k, 0).rgb;
    }
  }
  return max(sum, vec3f(0.0)) * views.plates[k].gain.rgb;
}

// The point of a receiver's front or back at a pixel; beyond all receivers it is on the first one's
// plane.
fn point_beyond(region_px: vec2f) -> ReceiverPoint {
  let point = surface_point(region_px);
  if is_hit(point) { return point; }
  let p = globals.receivers[0].plane_from_region_px * vec3f(region_px, 1.0);
  if p.z <= 0.0 { return point; }
  return point_on(0u, p.xy / p.z);
}

// A camera's colour at a pixel, without the receiver's reflection of its surroundings.
fn without_reflection(color: vec3f, region_px: vec2f, camera: vec3f) -> vec3f {
  let point = receiver_point(region_px);
  if !is_hit(point) { return color; }
  return max(color - reflected_to(camera, point, vec4f(1.0), 1.0), vec3f(0.0));
}

// The plate of this camera itself.
@fragment
fn fs_copy(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2u(at.xy) + vec2u(globals.region_origin_px);
  let color = textureLoad(plates, texel, 0u, 0).rgb * views.plates[0].gain.rgb;
  if all(globals.reflection_channel == vec4f(0.0)) { return vec4f(color, 1.0); }
  return vec4f(without_reflection(color, at.xy, globals.camera_in_anchor), 1.0);
}

// The plates' views are components of vectors: arrays that are indexed dynamically would lie in
// memory.
@fragment
fn fs_choose(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let point = point_beyond(at.xy);
  if !is_hit(point) { return vec4f(0.0); }
  let sight = sight_of(point, at.xy);
  var x = vec4f(0.0);
  var y = vec4f(0.0);
  var quality = vec4f(0.0);
  var inside = vec4f(0.0);
  for (var k = 0u; k < views.n_plates; k++) {
    let seen = candidate(k, point, sight);
    x[k] = seen.x;
    y[k] = seen.y;
    quality[k] = seen.z;
    inside[k] = seen.w;
  }
  let best_quality = max(max(quality.x, quality.y), max(quality.z, quality.w));
  if best_quality == 0.0 { return vec4f(0.0); }
  // Weights are relative to the best, so that powers of low qualities do not underflow.
  var weights = vec4f(0.0);
  for (var k = 0u; k < views.n_plates; k++) { weights[k] = inside[k] * choice_weight(quality[k] / best_quality); }
  let best = max(max(weights.x, weights.y), max(weights.z, weights.w));
  // The plates in use come first: mostly one or two, and plates that neighbours do not use cost
  // nothing.
  var looked_at = vec4u(0u);
  var n_looked_at = 0u;
  for (var k = 0u; k < views.n_plates; k++) {
    if weights[k] == 0.0 || weights[k] < LEAST_WEIGHT * best { continue; }
    looked_at[n_looked_at] = k;
    n_looked_at++;
  }
  var sum = vec4f(0.0);
  for (var i = 0u; i < n_looked_at; i++) {
    let k = looked_at[i];
    let color = sharp_color(k, vec2f(x[k], y[k]));
    sum += weights[k] * vec4f(without_reflection(color, at.xy, views.plates[k].camera_in_plane[0].xyz), 1.0);
  }
  return vec4f(sum.rgb / sum.a, 1.0);
}
