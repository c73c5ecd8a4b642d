// The paper's mask 3a: the pixels in which the camera sees the physical toy.
//
// Reads: physical positions in anchor space. Writes: 0 or 1.
// Source: Casas et al. 2018, section 4.2.

//#import common/globals

@vertex
fn vs_project(@location(0) in_anchor: vec3f) -> @builtin(position) vec4f {
  return globals.clip_from_anchor * vec4f(in_anchor, 1.0);
}

@fragment
fn fs_set() -> @location(0) vec4f {
  return vec4f(1.0);
}
