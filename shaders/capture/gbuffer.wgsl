// The toy in its physical pose as the camera sees it: base colour, normal, received light and depth.
//
// Reads: physical positions and normals in anchor space, materials, depth maps from the lights. Writes: base colour
// (linear, the part of the surface's view above the horizon in alpha), unit normal in anchor space and the material's index, each light's cosine times its
// visibility, reversed depth.

//#import common/self_shadow
//#import common/material
//#import common/behind
//#import common/hemispheres

struct Vertex {
  @builtin(instance_index) material: u32,
  @location(0) in_anchor: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
}

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) normal: vec3f,
  @location(1) uv: vec2f,
  @location(2) color: vec4f,
  @location(3) in_anchor: vec3f,
  @location(4) @interpolate(flat, either) material: u32,
}

@vertex
fn vs_project(in: Vertex) -> Surface {
  let clip = globals.clip_from_anchor * vec4f(in.in_anchor, 1.0);
  return Surface(clip, in.normal, in.uv, in.color, in.in_anchor, in.material);
}

struct GbufferTexel {
  @location(0) base: vec4f,
  @location(1) normal: vec4f,
  @location(2) received: vec4f,
}

@fragment
fn fs_describe(
  @builtin(position) at: vec4f,
  @location(0) interpolated_normal: vec3f,
  @location(1) uv: vec2f,
  @location(2) color: vec4f,
  @location(3) in_anchor: vec3f,
  @location(4) @interpolate(flat, either) material: u32,
) -> GbufferTexel {
  let base = base_color(material, uv, color);
  if is_behind_receiver(at.xy + globals.physical_box_origin_px, at.w) { discard; }
  let normal = unit_normal(interpolated_normal);
  return GbufferTexel(
    vec4f(base, hemispheres(normal).x), vec4f(normal, f32(material)), light_received(true, normal, in_anchor)
  );
}
