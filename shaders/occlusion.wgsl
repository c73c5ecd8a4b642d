// Shadows of the posed toy on the receiver, from 16 points of a light a colour target, in one pass.
//
// Each instance flattens the mesh from one light point onto the receiver and draws it where the camera sees it, so a
// contact edge is as sharp as the screen. Point i sets channel (i / 4) % 4 of target i / 16 at multisample position
// i % 4; blending keeps the maximum, and the resolve averages four points. No depth, hence no bias and no acne.
//
// Reads: posed positions in plane space. Writes: share of four light points hidden, per channel, in [0, 1].
// Twin: reference/occlusion.rs. Source: Heckbert and Herf 1997 (accumulated projections).
// Here the accumulation is done by the multisample resolve of one pass rather than by one pass a point.

struct LightPoints {
  // Homogeneous, in plane space: (position, 1) or (unit direction, 0).
  points: array<vec4f, 64>,
}

@group(1) @binding(0) var<uniform> light_points: LightPoints;

struct Flattened {
  @builtin(position) clip: vec4f,
  // Where the triangle covers the pixel: at its centre alone the height may be that of a point beyond the triangle.
  @location(0) @interpolate(perspective, centroid) height_m: f32,
  @location(1) @interpolate(flat, either) point: u32,
}

@vertex
fn vs_flatten(@location(0) in_plane: vec3f, @builtin(instance_index) point: u32) -> Flattened {
  var out: Flattened;
  out.clip = clip_from_flattened(flatten(light_points.points[point], in_plane));
  out.height_m = in_plane.y;
  out.point = point;
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
