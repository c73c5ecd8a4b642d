// Percentage-closer soft shadows of the animated toy for each light, in the edge region.
//
// The kernel is a disc perpendicular to the ray to the light, as in a shadow map, projected to the
// receiver and on to the image. Its radius follows from the light's size and the mean height of the
// blockers, which are searched on the receiver within the penumbra of the tallest one. If all
// blocker taps agree, there is no edge and nothing is filtered.
//
// Reads: warp of each light (occluder's height, coverage). Writes: visibility in [0, 1], one
// channel per light.
// CPU reference: tests/reference/src/pcss.rs. Source: Fernando 2005; Casas et al. 2018, section
// 3.5.

//#import common/baseline
//#import common/fullscreen

@group(1) @binding(0) var warp: texture_2d_array<f32>;

// Beyond a receiver's edge the adjacent receiver's texels are read: shadows meet at the edge.
fn warp_near(point: ReceiverPoint, light: u32) -> vec4f {
  let region_px = region_px_of(point);
  if any(region_px < vec2f(0.0)) || any(region_px >= globals.region_size_px) { return vec4f(0.0); }
  return textureLoad(warp, vec2i(region_px), light, 0);
}

// Point k of n on the unit disc: Vogel's spiral.
fn disc_point(k: u32, n: u32) -> vec2f {
  let turn = f32(k) * 2.3999632;
  return sqrt((f32(k) + 0.5) / f32(n)) * vec2f(cos(turn), sin(turn));
}

// Penumbra radius on the receiver of an occluder at `height_m`, limited to that height: a disc that
// fills more than 45 degrees around the vertical has a wider penumbra, which is unbounded for an
// occluder as high as the light.
fn penumbra_radius_m(height_m: f32, receiver: u32, light: u32) -> f32 {
  let at = globals.receivers[receiver].lights[light];
  let radius = globals.light_radii[light];
  if radius == 0.0 { return 0.0; }
  return radius * height_m / max(at.y - at.w * height_m, radius);
}

// A point of a disc perpendicular to the ray to the light, projected along that ray onto the receiver: the projection
// is longer by 1 / sine of the light's elevation, away from the light.
fn slanted(disc: vec2f, point: ReceiverPoint, light: u32) -> ReceiverPoint {
  let at = globals.receivers[receiver_of(point)].lights[light];
  let to_light = normalize(at.xyz - at.w * vec3f(point.xy.x, 0.0, point.xy.y));
  let longer = to_light.xz * (dot(to_light.xz, disc) / (to_light.y * (1.0 + to_light.y)));
  return point_on(receiver_of(point), point.xy + disc + longer);
}

fn visibility_at(texel: vec2i, point: ReceiverPoint, half_pixel_m: f32, light: u32) -> f32 {
  // A light behind the receiver casts no shadow on it.
  if globals.receivers[receiver_of(point)].lights[light].y <= 0.0 { return 1.0; }
  let here = textureLoad(warp, texel, light, 0);
  // At least half a pixel, so that a hard edge is antialiased.
  let tallest_m = baseline.tallest_m[receiver_of(point)];
  let reach_m = max(penumbra_radius_m(tallest_m, receiver_of(point), light), half_pixel_m);
  var height_sum = 0.0;
  var n_blocked = 0.0;
  for (var k = 0u; k < baseline.n_blocker_taps; k++) {
    let disc = reach_m * disc_point(k, baseline.n_blocker_taps);
    let tap = warp_near(point_on(receiver_of(point), point.xy + disc), light);
    height_sum += tap.a * tap.z;
    n_blocked += tap.a;
  }
  if n_blocked == 0.0 { return 1.0 - here.a; }
  if n_blocked == f32(baseline.n_blocker_taps) && here.a == 1.0 { return 0.0; }
  let radius_m = max(penumbra_radius_m(height_sum / n_blocked, receiver_of(point), light), half_pixel_m);
  var blocked = 0.0;
  for (var k = 0u; k < baseline.n_filter_taps; k++) {
    let disc = radius_m * disc_point(k, baseline.n_filter_taps);
    blocked += warp_near(slanted(disc, point, light), light).a;
  }
  return 1.0 - blocked / f32(baseline.n_filter_taps);
}

@fragment
fn fs_soften(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let point = receiver_point(at.xy);
  if !is_hit(point) { return vec4f(1.0); }
  let next = globals.receivers[receiver_of(point)].plane_from_region_px * vec3f(at.xy + vec2f(1.0, 0.0), 1.0);
  let half_pixel_m = select(0.0, 0.5 * distance(next.xy / next.z, point.xy), next.z > 0.0);
  var visibility = vec4f(1.0);
  for (var light = 0u; light < globals.n_lights; light++) {
    visibility[light] = visibility_at(vec2i(at.xy), point, half_pixel_m, light);
  }
  return visibility;
}
