// Fraction of each pixel that the posed toy covers, counted over many positions in one pass.
//
// Each instance draws the mesh moved so that the pixel's centre samples its position; blending adds
// them up. As in `occlusion` each position has a constant depth, above those before it, so that
// overlapping triangles do not count twice; rounding of z / w is far below a step of 16 bits, in
// which depths are 1986 steps apart. A position counts if any triangle covers it: of the scene's
// depths only those of the receivers are tested, and the fronts of things before the toy.
// All positions are equal away from the toy's silhouettes: there it is drawn only once, while tiles
// near a silhouette are closed (`geometry/silhouette.rs`); beside things with fronts all are drawn everywhere.
// The positions are a lattice over the pixel, so that an edge of any direction meets them one after
// the other.
//
// Reads: posed positions in anchor space, validity beside things with fronts. Writes: COVERED_POSITION for
// each position of the lattice that the toy covers.
// Source: Fiume, Fournier and Rudolph 1983 (coverage masks); the lattice is that of Korobov 1959.

//#import common/behind
//#import common/covered
//#import common/over_things
//#import common/spread
//#import common/tiles

struct Positions {
  // Number of drawn positions, N_POSITIONS or a part of it: each one has the weight of several.
  n: u32,
  // Rows from one column's position to the next.
  row_step: u32,
}

@group(1) @binding(0) var<uniform> positions: Positions;
@group(1) @binding(1) var validity: texture_2d<f32>;

struct Moved {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, either) index: u32,
}

// Offset from the pixel's centre, which in a soft picture may be outside the pixel.
fn position_px(index: u32) -> vec2f {
  let lattice = (vec2f(vec2u(index, index * positions.row_step % positions.n)) + 0.5) / f32(positions.n);
  if is_soft() { return spread_position_px(lattice); }
  return lattice - 0.5;
}

// Clip position of a corner at `clip`, drawn for a position.
fn moved_clip(clip: vec4f, index: u32) -> vec4f {
  let moved = clip.xy - clip.w * vec2f(2.0, -2.0) * position_px(index) / globals.region_size_px;
  return vec4f(moved, clip.w * f32(index + 1u) / f32(N_POSITIONS + 1u), clip.w);
}

@vertex
fn vs_move(@location(0) in_anchor: vec3f, @builtin(instance_index) index: u32) -> Moved {
  let clip = globals.clip_from_anchor * vec4f(in_anchor, 1.0);
  return Moved(moved_clip(clip, index), index);
}

struct BeforeFronts {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, either) index: u32,
  @location(1) before_m: vec2f,
}

// Vertices with their distances from the fronts of things.
@vertex
fn vs_before_fronts(@location(0) in_anchor: vec3f, @builtin(instance_index) index: u32) -> BeforeFronts {
  let clip = globals.clip_from_anchor * vec4f(in_anchor, 1.0);
  return BeforeFronts(moved_clip(clip, index), index, before_fronts_m(in_anchor));
}

struct Plain {
  @builtin(position) clip: vec4f,
  @location(0) on_receiver: vec3f,
}

// Vertices in front of a single receiver.
@vertex
fn vs_plain(@location(0) in_anchor: vec3f, @builtin(instance_index) index: u32) -> Plain {
  let clip = globals.clip_from_anchor * vec4f(in_anchor, 1.0);
  return Plain(moved_clip(clip, index), on_first_receiver(clip));
}

@fragment
fn fs_cover_plain(@location(0) on_receiver: vec3f) -> @location(0) vec4f {
  if is_behind_first(on_receiver) { discard; }
  return covered();
}

// A depth above all positions, so that none counts again.
@vertex
fn vs_once(@location(0) in_anchor: vec3f) -> @builtin(position) vec4f {
  let clip = globals.clip_from_anchor * vec4f(in_anchor, 1.0);
  let depth = (f32(N_POSITIONS) + 0.5) / f32(N_POSITIONS + 1u);
  return vec4f(clip.xy, clip.w * depth, clip.w);
}

// The value of one position.
fn covered() -> vec4f {
  return vec4f(f32(N_POSITIONS / positions.n) * COVERED_POSITION);
}

// All positions of a pixel away from silhouettes.
@fragment
fn fs_cover_all() -> @location(0) vec4f {
  return vec4f(f32(N_POSITIONS) * COVERED_POSITION);
}

@fragment
fn fs_cover(@builtin(position) at: vec4f, @location(0) @interpolate(flat, either) index: u32) -> @location(0) vec4f {
  // w is the inverse depth at the position.
  if is_behind_receiver(at.xy + globals.toy_box_origin_px + position_px(index), at.w) { discard; }
  return covered();
}

// The same beside things before the toy with fronts.
@fragment
fn fs_cover_over_things(
  @builtin(position) at: vec4f,
  @location(0) @interpolate(flat, either) index: u32,
  @location(1) before_m: vec2f,
) -> @location(0) vec4f {
  let in_region = at.xy + globals.toy_box_origin_px;
  if is_behind_receiver(in_region + position_px(index), at.w) { discard; }
  if is_behind_thing(vec2i(in_region), before_m) { discard; }
  return covered();
}
