// Constants that the papers leave open, tuned as `preset.rs` states, and properties of the scene.

//#import common/globals

struct Baseline {
  // Upper bound of the toy's height over each receiver, in metres.
  tallest_m: vec4f,
  // Bit k is 1 if receiver k is textured: its shadow terms are ratios to the plate. For 0 they are
  // colours.
  textured_receivers: u32,
  // 0: search for real shadow. 1: a constant ratio.
  is_constant: u32,
  // Shadow over plate of one light.
  constant_ratio: f32,
  // Distance kept from the edges of the eligible shadow.
  eligible_margin_px: i32,
  ring_step_px: f32,
  n_ring_directions: u32,
  n_rings: u32,
  box_radius_px: i32,
  // Width of the linear blend around the cropped masks.
  seam_px: i32,
  n_blocker_taps: u32,
  n_filter_taps: u32,
  _pad: u32,
}

@group(0) @binding(1) var<uniform> baseline: Baseline;

// A set of hidden lights: bit i stands for light i. 0 is fully lit.

// Label of a shadow: the receiver and the set of hidden lights in one number; 0 without a shadow.
const N_SETS: u32 = 16u;

fn label_of(receiver: u32, lights: u32) -> u32 {
  return select(receiver * N_SETS + lights, 0u, lights == 0u);
}

// The receiver that a texel shows; if there is only one, every texel belongs to it.
fn receiver_at(texel: vec2i) -> u32 {
  if globals.n_receivers == 1u { return 0u; }
  return receiver_of(receiver_point(vec2f(texel) + 0.5));
}

// Distance between the sets of lights `has` and `wanted`: first the number of lights that differ;
// among equals a set without superfluous hidden lights is closer.
fn unlikeness(wanted: u32, has: u32) -> u32 {
  return 2u * countOneBits(wanted ^ has) + select(0u, 1u, (has & ~wanted) != 0u);
}
