// How much of each pixel the posed toy covers, from 16 positions a colour target, in one pass.
//
// Position i sets channel (i / 4) % 4 of target i / 16 at multisample position i % 4: its instance draws the mesh moved so
// that this sample sees the position. Blending keeps the maximum, and the resolve averages four positions. Where any triangle
// covers a position the toy does, so there is no depth but that of the receivers.
// The positions are a lattice over the pixel, so that an edge of whatever direction meets them one after the other.
//
// Reads: posed positions in stage space. Writes: share of four positions covered, per channel, in [0, 1].
// Source: Fiume, Fournier and Rudolph 1983 (coverage masks); the lattice is that of Korobov 1959.

const N_POSITIONS: u32 = 32u;
// Rows from one column's position to the next one's: of all lattices of 32 this one has the least error at a straight edge.
const LATTICE_STEP: u32 = 9u;

// Where the four samples of a pixel lie, from its corner. Source: WebGPU, standard sample pattern.
const MULTISAMPLE_PX = array<vec2f, 4>(
  vec2f(0.375, 0.125),
  vec2f(0.875, 0.375),
  vec2f(0.125, 0.625),
  vec2f(0.625, 0.875),
);

struct Moved {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, either) index: u32,
}

// From the pixel's corner.
fn position_px(index: u32) -> vec2f {
  return (vec2f(vec2u(index, index * LATTICE_STEP % N_POSITIONS)) + 0.5) / f32(N_POSITIONS);
}

fn sample_px(index: u32) -> vec2f {
  var samples_px = MULTISAMPLE_PX;
  return samples_px[index % 4u];
}

@vertex
fn vs_move(@location(0) in_stage: vec3f, @builtin(instance_index) index: u32) -> Moved {
  let move_px = sample_px(index) - position_px(index);
  var clip = globals.clip_from_stage * vec4f(in_stage, 1.0);
  clip += vec4f(clip.w * vec2f(2.0, -2.0) * move_px / globals.region_size_px, 0.0, 0.0);
  return Moved(clip, index);
}

struct Covered {
  @location(0) positions_0: vec4f,
  @location(1) positions_16: vec4f,
  @builtin(sample_mask) samples: u32,
}

@fragment
fn fs_cover(in: Moved) -> Covered {
  // Inverse depth is linear on the screen: from the pixel's centre to the sample.
  let slope = vec2f(dpdx(in.clip.w), dpdy(in.clip.w));
  let inverse_depth = in.clip.w + dot(slope, sample_px(in.index) - 0.5);
  if is_behind_receiver(floor(in.clip.xy) + position_px(in.index), inverse_depth) { discard; }
  let one = vec4f(vec4u(0u, 1u, 2u, 3u) == vec4u((in.index / 4u) % 4u));
  let slot = in.index / 16u;
  return Covered(
    select(vec4f(0.0), one, slot == 0u),
    select(vec4f(0.0), one, slot == 1u),
    1u << (in.index % 4u),
  );
}
