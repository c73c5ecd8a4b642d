// Percentage-closer soft shadows of the animated toy, in the edge region.
//
// The kernel is a disc on the receiver, projected to the image. Its radius follows from the mean height of the blockers
// around and the light's size; where all blocker taps agree there is no edge and nothing is filtered.
//
// Reads: warp (occluder's height, coverage). Writes: visibility in [0, 1].
// Twin: reference/pcss.rs. Source: Fernando 2005; Casas et al. 2018, section 3.5.

@group(1) @binding(0) var warp: texture_2d<f32>;

fn warp_near(in_plane: vec2f) -> vec4f {
  let at = globals.receivers[0].clip_from_plane * vec3f(in_plane, 1.0);
  if at.z <= 0.0 { return vec4f(0.0); }
  let region_px = (at.xy / at.z * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
  if any(region_px < vec2f(0.0)) || any(region_px >= globals.region_size_px) { return vec4f(0.0); }
  return textureLoad(warp, vec2i(region_px), 0);
}

// Point k of n on the unit disc: Vogel's spiral.
fn disc_point(k: u32, n: u32) -> vec2f {
  let turn = f32(k) * 2.3999632;
  return sqrt((f32(k) + 0.5) / f32(n)) * vec2f(cos(turn), sin(turn));
}

// Radius on the receiver of the shadow of the light's disc through a point at `height_m`.
fn penumbra_radius_m(height_m: f32) -> f32 {
  if published.light.w == 0.0 { return published.light_radius * height_m / published.light.y; }
  let above_m = published.light.y - height_m;
  if above_m <= 0.0 { return 0.0; }
  return published.light_radius * height_m / above_m;
}

override TALLEST_M: f32 = 1.0;

@fragment
fn fs_soften(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let here = textureLoad(warp, vec2i(at.xy), 0);
  let point = receiver_point(at.xy);
  if point.receiver != 0u { return vec4f(1.0); }
  let pixel_width_m = distance(receiver_point(at.xy + vec2f(1.0, 0.0)).in_plane, point.in_plane);
  // Never less than half a pixel, so that a hard edge is antialiased.
  let reach_m = max(penumbra_radius_m(TALLEST_M), 0.5 * pixel_width_m);
  var height_sum = 0.0;
  var n_blocked = 0.0;
  for (var k = 0u; k < published.n_blocker_taps; k++) {
    let tap = warp_near(point.in_plane + reach_m * disc_point(k, published.n_blocker_taps));
    height_sum += tap.a * tap.z;
    n_blocked += tap.a;
  }
  if n_blocked == 0.0 { return vec4f(1.0 - here.a); }
  if n_blocked == f32(published.n_blocker_taps) && here.a == 1.0 { return vec4f(0.0); }
  let radius_m = max(penumbra_radius_m(height_sum / n_blocked), 0.5 * pixel_width_m);
  var blocked = 0.0;
  for (var k = 0u; k < published.n_filter_taps; k++) {
    blocked += warp_near(point.in_plane + radius_m * disc_point(k, published.n_filter_taps)).a;
  }
  return vec4f(1.0 - blocked / f32(published.n_filter_taps));
}
