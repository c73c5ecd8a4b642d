// Light on a receiver of the plate: irradiance by each light and by the sky, over that at the
// reference point.
//
// What stands on a receiver, such as a book, is known by its top, which is another receiver. The top
// and what is below it are opaque: between a point and a light they hide the light, and no further
// shadow falls there. And the faces below its edges hide a part of the sky. What lies on another
// thing hides only what that one leaves. Walls hide nothing: they may have a window.
// CPU reference: tests/reference/src/model.rs. Source: Nishita and Nakamae 1985 (Lambert's formula).

//#import common/globals

const INVERSE_PI: f32 = 0.31830989;
// Least radius of a light's disc, projected onto a top, in metres: a pixel shows no sharper edge.
const SHARPEST_M: f32 = 5e-4;
// Least cosine between a receiver and the top of what stands on it: a ramp of up to 60 degrees has a
// top, and what is steeper is taken for a wall.
const STANDS: f32 = 0.5;
// Least part of the sky: in the narrowest gap some of its light arrives by reflection, and a plate
// without any light has no shares of it.
const LEAST_SKY: f32 = 0.02;
// How dark a face is that no light meets, beside the sky that it hides: it reflects sky and table.
// After a blur, the shadow's error beside a book with white squares is .62 codes with 1, and .57 and
// .63 with .75 and .5; beside a box 1.06, and 1.02 and 1.05. Beside five other books and a ramp it
// stays the same.
const UNLIT_FACE: f32 = 0.75;

// The number of receivers, and 0 instead of 1: then none hides anything from another.
fn n_tops() -> u32 {
  return select(0u, globals.n_receivers, globals.n_receivers > 1u);
}

// `hidden` with the part that receiver `k` hides.
fn with_part(hidden: vec4f, k: u32, part: f32) -> vec4f {
  return select(hidden, vec4f(part), vec4u(0u, 1u, 2u, 3u) == vec4u(k));
}

// What receivers hide together: each adds what those below it do not hide.
fn hidden_by_all(hidden: vec4f) -> f32 {
  var sum = 0.0;
  for (var k = 0u; k < MAX_RECEIVERS; k++) {
    let below = hidden * globals.receivers[k].stands_on;
    sum += max(hidden[k] - max(max(below.x, below.y), max(below.z, below.w)), 0.0);
  }
  return sum;
}

// Part of the area of a disc on one side of lines at distances `t` from its centre, in radii.
fn disc_parts(t: vec2f) -> vec2f {
  let c = clamp(t, vec2f(-1.0), vec2f(1.0));
  return 0.5 + (asin(c) + c * sqrt(1.0 - c * c)) * INVERSE_PI;
}

// Distance of `at` from the line through the origin and `corner`, over the half width of a light's
// disc there: `radius` across the way to the light, whose slope is `slope`.
fn side_of(corner: vec2f, at: vec2f, radius: f32, slope: vec2f) -> f32 {
  let across = vec2f(-corner.y, corner.x);
  let most = radius * length(vec3f(across, dot(across, slope)));
  return dot(across, at) / max(most, SHARPEST_M * length(across));
}

// Part of a light's disc for which the way from `above` to `at`, seen from above, meets a rectangle:
// it enters by the edges that are turned to `above`, between the outermost corners. `across` is the
// radius of the disc across the way to the light, and `radius` that along either axis. A pixel with
// `above` within the rectangle shows a side, or the receiver beside a top that is listed too large:
// for it the top alone counts. If it were dark, the fit to a book whose sides are no receivers would
// be off: the shadow's error beside it, after a blur, 1.26 codes for .80.
fn entered(rect: vec4f, above: vec2f, at: vec2f, across: f32, radius: vec2f, slope: vec2f) -> f32 {
  let is_before = above < rect.xy;
  let is_behind = above > rect.zw;
  if !any(is_before) && !any(is_behind) { return 0.0; }
  let beyond_low = disc_parts((at - rect.xy) / radius);
  let beyond_high = disc_parts((rect.zw - at) / radius);
  let near = select(select(vec2f(1.0), beyond_high, is_behind), beyond_low, is_before);
  let low = rect.xy - above;
  let high = rect.zw - above;
  let way = at - above;
  let side_low = vec2f(side_of(low, way, across, slope), side_of(vec2f(high.x, low.y), way, across, slope));
  let side_high = vec2f(side_of(vec2f(low.x, high.y), way, across, slope), side_of(high, way, across, slope));
  let most = max(side_low, side_high);
  let least = min(side_low, side_high);
  let within = disc_parts(vec2f(max(most.x, most.y), -min(least.x, least.y)));
  return near.x * near.y * max(within.x + within.y - 1.0, 0.0);
}

// Part of light `i` that receiver `k`, and what is below it, hide from a point in that receiver's
// space, in which `up` is the direction upwards: the larger part of the two. From a point above the
// plane of a ramp's top, a light below that plane is hidden by the top alone.
fn hidden_by(k: u32, i: u32, here: vec3f, up: vec3f) -> f32 {
  let light = globals.receivers[k].lights[i];
  if here.y * light.y >= 0.0 { return 0.0; }
  let to_light = light.xyz - light.w * here;
  // The way to the light meets the plane after this part of it.
  let part = -here.y / to_light.y;
  let at = here.xz + part * to_light.xz;
  // Half the axes of the light's disc, projected onto the plane from the point.
  let slope = to_light.xz / to_light.y;
  let across = part * globals.light_radii[i];
  let radius = max(across * sqrt(1.0 + slope * slope), vec2f(SHARPEST_M));
  let rect = globals.receivers[k].rect;
  let within = max(disc_parts((at - rect.xy) / radius) + disc_parts((rect.zw - at) / radius) - 1.0, vec2f(0.0));
  let above = here.xz - here.y / up.y * up.xz;
  let below = select(0.0, entered(rect, above, at, across, radius, slope), here.y < 0.0);
  return max(within.x * within.y, below);
}

// Leads from a receiver's space to the anchor, without the origins.
fn anchor_turn(receiver: u32) -> mat3x3f {
  let m = globals.receivers[receiver].plane_from_anchor;
  return transpose(mat3x3f(m[0].xyz, m[1].xyz, m[2].xyz));
}

// Part of light `i` that the other receivers leave at a point.
fn unhidden(i: u32, point: ReceiverPoint) -> f32 {
  let own = receiver_of(point);
  let turn = anchor_turn(own);
  let from_origin = vec3f(point.x, 0.0, point.y) - globals.receivers[own].plane_from_anchor[3].xyz;
  let in_anchor = vec4f(turn * from_origin, 1.0);
  var hidden = vec4f(0.0);
  for (var k = 0u; k < n_tops(); k++) {
    if k == own || dot(anchor_turn(k)[1], turn[1]) < STANDS { continue; }
    let here = (globals.receivers[k].plane_from_anchor * in_anchor).xyz;
    let up = (globals.receivers[k].plane_from_anchor * vec4f(turn[1], 0.0)).xyz;
    hidden = with_part(hidden, k, hidden_by(k, i, here, up));
  }
  return max(1.0 - hidden_by_all(hidden), 0.0);
}

// Irradiance of light `i` at a receiver point relative to that at the receiver's reference point in
// the open: cos / d^2, with height over distance as the cosine, for the part of the light that no
// other receiver hides; 0 if the light is behind the receiver.
fn falloff(i: u32, point: ReceiverPoint) -> f32 {
  let light = globals.receivers[receiver_of(point)].lights[i];
  if light.y <= 0.0 { return 0.0; }
  let left = unhidden(i, point);
  if light.w == 0.0 { return left; }
  let reference = globals.receivers[receiver_of(point)].reference_in_plane;
  let to_here = distance(light.xyz, vec3f(point.xy.x, 0.0, point.xy.y));
  let to_reference = distance(light.xyz, vec3f(reference.x, 0.0, reference.y));
  let ratio = to_reference / to_here;
  return left * ratio * ratio * ratio;
}

// Angle between two directions.
fn angle_between(a: vec3f, b: vec3f) -> f32 {
  return atan2(length(cross(a, b)), dot(a, b));
}

// Part of the sky above a point that the upright face below an edge hides, from the edge's ends
// relative to the point; cosine-weighted.
fn hidden_below(a: vec3f, b: vec3f) -> f32 {
  let across = cross(a, b);
  let area = length(across);
  if area == 0.0 { return 0.0; }
  let ground = angle_between(vec3f(a.x, 0.0, a.z), vec3f(b.x, 0.0, b.z));
  return 0.5 * INVERSE_PI * max(ground - angle_between(a, b) * abs(across.y) / area, 0.0);
}

// Twice the area of a triangle with one corner at the origin, seen from above; its sign is the sense
// of rotation.
fn turn_of(a: vec3f, b: vec3f) -> f32 {
  return a.x * b.z - a.z * b.x;
}

// The corner of a rectangle, counted around it.
fn corner(rect: vec4f, index: u32) -> vec3f {
  let is_last = vec2<bool>(index == 1u || index == 2u, index >= 2u && index != 4u);
  let at = select(rect.xy, rect.zw, is_last);
  return vec3f(at.x, 0.0, at.y);
}

// How dark the face below an edge of receiver `k` is, beside the sky that it hides. One that a light
// meets counts as dark: the toy's shadow on a receiver beside it is on the face, too.
fn darkness_of_face(k: u32, index: u32) -> f32 {
  let start = corner(globals.receivers[k].rect, index).xz;
  let along = corner(globals.receivers[k].rect, index + 1u).xz - start;
  let outwards = vec2f(along.y, -along.x);
  var most = 0.0;
  for (var i = 0u; i < globals.n_lights; i++) {
    let light = globals.receivers[k].lights[i];
    most = max(most, dot(light.xz - light.w * start, outwards));
  }
  return select(UNLIT_FACE, 1.0, most > 0.0);
}

// The part of the sky that the faces below receiver `k` hide, of those that are turned to the point.
// The matrix leads from that receiver's space to directions from the point.
fn hidden_by_thing(k: u32, turn: mat3x3f, origin: vec3f) -> f32 {
  let rect = globals.receivers[k].rect;
  let middle = turn * vec3f(0.5 * (rect.x + rect.z), 0.0, 0.5 * (rect.y + rect.w)) + origin;
  var hidden = 0.0;
  for (var index = 0u; index < 4u; index++) {
    var a = turn * corner(rect, index) + origin;
    var b = turn * corner(rect, index + 1u) + origin;
    let is_turned_here = turn_of(a, b) * turn_of(a - middle, b - middle) < 0.0;
    // Nothing below the point's own receiver hides any of its sky.
    a.y = max(a.y, 0.0);
    b.y = max(b.y, 0.0);
    let darkness = darkness_of_face(k, index);
    if is_turned_here { hidden += darkness * hidden_below(a, b); }
  }
  return hidden;
}

// Part of the sky that is open above a point, LEAST_SKY at least, with what faces reflect in place of
// the rest. With .7 and 1.3 of the part of all faces, the RMS error of the shadow beside two listed books is .59 and .57 for .56 codes, and
// 1.36 and 1.40 for 1.33.
fn open_sky(point: ReceiverPoint) -> f32 {
  let own = receiver_of(point);
  let own_turn = transpose(anchor_turn(own));
  let own_origin = globals.receivers[own].plane_from_anchor[3].xyz;
  var hidden = vec4f(0.0);
  for (var k = 0u; k < n_tops(); k++) {
    if k == own { continue; }
    let turn = own_turn * anchor_turn(k);
    if turn[1].y < STANDS { continue; }
    let origin = own_origin - turn * globals.receivers[k].plane_from_anchor[3].xyz - vec3f(point.x, 0.0, point.y);
    hidden = with_part(hidden, k, hidden_by_thing(k, turn, origin));
  }
  return max(1.0 - hidden_by_all(hidden), LEAST_SKY);
}
