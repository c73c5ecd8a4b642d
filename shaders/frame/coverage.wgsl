// How much of each pixel the posed toy covers, counted over many positions in one pass.
//
// Each instance draws the mesh moved so that the pixel's centre sees its position; the target adds up. As in `occlusion`
// each position has a depth of its own, above those before it, so that triangles that overlap do not count twice; rounding
// of z / w is far from a step of 16 bits, in which depths are 1986 steps apart. Where any
// triangle covers a position the toy does: no depth of the scene is asked for but that of the receivers.
// The positions are a lattice over the pixel, so that an edge of whatever direction meets them one after the other.
//
// Reads: posed positions in stage space. Writes: COVERED_POSITION for each position that the toy covers.
// Source: Fiume, Fournier and Rudolph 1983 (coverage masks); the lattice is that of Korobov 1959.

// Rows from one column's position to the next one's: of all lattices of 32 this one has the least error at a straight edge.
const LATTICE_STEP: u32 = 9u;

struct Moved {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, either) index: u32,
}

// From the pixel's centre.
fn position_px(index: u32) -> vec2f {
  return (vec2f(vec2u(index, index * LATTICE_STEP % N_POSITIONS)) + 0.5) / f32(N_POSITIONS) - 0.5;
}

@vertex
fn vs_move(@location(0) in_anchor: vec3f, @builtin(instance_index) index: u32) -> Moved {
  let clip = globals.clip_from_anchor * vec4f(in_anchor, 1.0);
  let moved = clip.xy - clip.w * vec2f(2.0, -2.0) * position_px(index) / globals.region_size_px;
  let depth = f32(index + 1u) / f32(N_POSITIONS + 1u);
  return Moved(vec4f(moved, clip.w * depth, clip.w), index);
}

@fragment
fn fs_cover(@builtin(position) at: vec4f, @location(0) @interpolate(flat, either) index: u32) -> @location(0) vec4f {
  // w is the inverse depth of what the position sees.
  if is_behind_receiver(at.xy + position_px(index), at.w) { discard; }
  return vec4f(COVERED_POSITION);
}
