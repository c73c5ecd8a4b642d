// Depth maps of the posed toy from points of each light, all of them tiles of one atlas.
//
// Each instance draws the toy into a tile that contains it fully, so nothing is clipped between
// tiles.
// Reads: posed positions in anchor space. Writes: reversed depth.
// CPU reference: tests/reference/src/self_shadow.rs.

//#import common/self_shadow

@vertex
fn vs_light(@location(0) in_anchor: vec3f, @builtin(instance_index) tile: u32) -> @builtin(position) vec4f {
  return self_shadow.atlas_from_anchor[tile] * vec4f(in_anchor, 1.0);
}

@fragment
fn fs_depth() {}
