// Shadows of the posed toy on the receivers, from 16 points of a light a pass.
//
// Each instance flattens the mesh from one light point onto one receiver and draws it where the camera sees it, so a
// contact edge is as sharp as the screen. Of 16 points, point i sets channel i / 4 at multisample position i % 4; the
// target saturates, and the resolve averages four points. No depth, hence no bias and no acne.
// A pixel shows one receiver, so that all of them share the targets: `fs_route` first writes into the stencil which one,
// and each draws only there.
// Of a closed mesh only the side that faces the light is drawn: what a ray from the receiver enters it leaves again.
//
// Reads: posed positions in stage space. Writes: share of four light points hidden, per channel, in [0, 1].
// Twin: reference/occlusion.rs. Source: Heckbert and Herf 1997 (accumulated projections).
// Here the accumulation is done by the multisample resolve, 16 points a pass, rather than by one pass a point.

struct LightPoints {
  // Homogeneous: (position, 1) or (unit direction, 0); point k in the space of receiver r is number r n_points + k.
  points: array<vec4f, 256>,
  // Size of a target's texel in the region.
  texel_px: vec2f,
  n_points: u32,
  _pad: u32,
}

@group(1) @binding(0) var<uniform> light_points: LightPoints;

struct Routed {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, either) receiver: u32,
}

// The whole target, once for each receiver.
@vertex
fn vs_route(@builtin(vertex_index) index: u32, @builtin(instance_index) receiver: u32) -> Routed {
  let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
  return Routed(vec4f(corner * 2.0 - 1.0, 0.0, 1.0), receiver);
}

@fragment
fn fs_route(in: Routed) {
  if receiver_point(in.clip.xy * light_points.texel_px).receiver != in.receiver { discard; }
}

struct Flattened {
  @builtin(position) clip: vec4f,
  // Where the triangle covers the pixel: at its centre alone the height may be that of a point beyond the triangle.
  @location(0) @interpolate(perspective, centroid) height_m: f32,
  @location(1) @interpolate(flat, either) point: u32,
}

@vertex
fn vs_flatten(@location(0) in_stage: vec3f, @builtin(instance_index) instance: u32) -> Flattened {
  let receiver = instance / light_points.n_points;
  let in_plane = (globals.receivers[receiver].plane_from_stage * vec4f(in_stage, 1.0)).xyz;
  let shadow = flatten(light_points.points[instance], in_plane);
  return Flattened(clip_from_flattened(receiver, shadow), in_plane.y, instance % light_points.n_points % 16u);
}

struct Hidden {
  @location(0) points: vec4f,
  @builtin(sample_mask) samples: u32,
}

@fragment
fn fs_cover(in: Flattened) -> Hidden {
  let channel = vec4f(vec4u(0u, 1u, 2u, 3u) == vec4u(in.point / 4u));
  // What lies under the receiver casts nothing on it.
  return Hidden(channel, select(0u, 1u << (in.point % 4u), in.height_m >= 0.0));
}
