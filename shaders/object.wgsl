// The toy in its physical pose as the camera sees it: base colour, normal and depth.
//
// Reads: physical positions and normals in plane space, materials. Writes: base colour (linear, alpha 1 on the toy),
// unit normal in plane space, reversed depth.

struct Vertex {
  @location(0) in_plane: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) color: vec4f,
}

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) normal: vec3f,
  @location(1) uv: vec2f,
  @location(2) color: vec4f,
}

@vertex
fn vs_project(in: Vertex) -> Surface {
  return Surface(globals.clip_from_stage * vec4f(in.in_plane, 1.0), in.normal, in.uv, in.color);
}

struct ObjectTexel {
  @location(0) base: vec4f,
  @location(1) normal: vec4f,
}

@fragment
fn fs_describe(in: Surface) -> ObjectTexel {
  return ObjectTexel(vec4f(base_color(in.uv, in.color), 1.0), vec4f(unit_normal(in.normal), 0.0));
}
