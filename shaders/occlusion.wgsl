// Shadows of the posed toy on the receivers, from 16 points of a light a colour target, in one pass.
//
// Each instance flattens the mesh from one light point onto one receiver and draws it where the camera sees it, so a
// contact edge is as sharp as the screen. Point i sets channel (i / 4) % 4 of target i / 16 at multisample position
// i % 4; blending keeps the maximum, and the resolve averages four points. No depth, hence no bias and no acne.
// A pixel shows one receiver, so that all of them share the targets: each draws only where it is seen.
//
// Reads: posed positions in stage space. Writes: share of four light points hidden, per channel, in [0, 1].
// Twin: reference/occlusion.rs. Source: Heckbert and Herf 1997 (accumulated projections).
// Here the accumulation is done by the multisample resolve of one pass rather than by one pass a point.

struct LightPoints {
  // Homogeneous: (position, 1) or (unit direction, 0); point k in the space of receiver r is number r n_points + k.
  points: array<vec4f, 256>,
  // Size of a target's texel in the region.
  texel_px: vec2f,
  n_points: u32,
  _pad: u32,
}

// Whether there are several receivers, of which a pixel shows one.
override IS_SHARED: bool = true;

@group(1) @binding(0) var<uniform> light_points: LightPoints;

struct Flattened {
  @builtin(position) clip: vec4f,
  // Where the triangle covers the pixel: at its centre alone the height may be that of a point beyond the triangle.
  @location(0) @interpolate(perspective, centroid) height_m: f32,
  @location(1) @interpolate(flat, either) point: u32,
  @location(2) @interpolate(flat, either) receiver: u32,
}

@vertex
fn vs_flatten(@location(0) in_stage: vec3f, @builtin(instance_index) instance: u32) -> Flattened {
  let receiver = instance / light_points.n_points;
  let in_plane = (globals.receivers[receiver].plane_from_stage * vec4f(in_stage, 1.0)).xyz;
  var out: Flattened;
  out.clip = clip_from_flattened(receiver, flatten(light_points.points[instance], in_plane));
  out.height_m = in_plane.y;
  out.point = instance % light_points.n_points;
  out.receiver = receiver;
  return out;
}

struct Hidden {
  @location(0) points_0: vec4f,
  @location(1) points_16: vec4f,
  @location(2) points_32: vec4f,
  @location(3) points_48: vec4f,
  @builtin(sample_mask) samples: u32,
}

@fragment
fn fs_cover(in: Flattened) -> Hidden {
  // What lies under the receiver casts nothing on it.
  if in.height_m < 0.0 { discard; }
  if IS_SHARED {
    let centre = (floor(in.clip.xy) + 0.5) * light_points.texel_px;
    if receiver_point(centre).receiver != in.receiver { discard; }
  }
  let one = vec4f(vec4u(0u, 1u, 2u, 3u) == vec4u((in.point / 4u) % 4u));
  let slot = in.point / 16u;
  return Hidden(
    select(vec4f(0.0), one, slot == 0u),
    select(vec4f(0.0), one, slot == 1u),
    select(vec4f(0.0), one, slot == 2u),
    select(vec4f(0.0), one, slot == 3u),
    1u << (in.point % 4u),
  );
}
