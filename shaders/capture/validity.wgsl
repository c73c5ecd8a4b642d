// Validity mask of the frame: r is 1 if the pixel is clear of the toy; g is 1 if it shows one surface of the
// toy, MIXED if another one is within the picture's spread; b is 1 if it is well clear of the toy: colours
// bleed in a compressed picture, and no pose is exact; a is 1. All others are 0.
//
// Pixels that mix two surfaces (an outline, camera blur, a pose half a pixel off) are valid as
// neither.
// Reads: depth of the physical toy. Writes: 0 or 1 in r and b; 0, MIXED or 1 in g.
// CPU reference: tests/reference/src/validity.rs.

//#import common/depth
//#import common/fullscreen
//#import common/mixed

@group(1) @binding(0) var gbuffer_depth: texture_depth_2d;
// Added to the distance from the toy's outline: the distance over which a soft picture spreads the
// toy.
@group(1) @binding(1) var<uniform> soft_px: i32;

// Distance kept from the toy's outline on the receiver.
const EDGE_PX: i32 = 2;
// The same for estimating a pixel's own plate. Rows and columns are sampled in steps, and every
// other row between the columns of the next, so that no part of two pixels is missed.
const BLEED_PX: i32 = 8;
const BLEED_STEP_PX: i32 = 2;

fn depth_at(texel: vec2i) -> f32 {
  let last = vec2i(textureDimensions(gbuffer_depth)) - 1;
  return textureLoad(gbuffer_depth, clamp(texel, vec2i(0), last), 0);
}

fn is_clear_of_toy(texel: vec2i) -> bool {
  let edge_px = EDGE_PX + soft_px;
  for (var y = -edge_px; y <= edge_px; y++) {
    for (var x = -edge_px; x <= edge_px; x++) {
      if depth_at(texel + vec2i(x, y)) > 0.0 { return false; }
    }
  }
  return true;
}

fn is_well_clear_of_toy(texel: vec2i) -> bool {
  for (var y = -BLEED_PX; y <= BLEED_PX; y += BLEED_STEP_PX) {
    let first = -BLEED_PX + ((BLEED_PX + y) % (2 * BLEED_STEP_PX));
    for (var x = first; x <= BLEED_PX; x += 2 * BLEED_STEP_PX) {
      if depth_at(texel + vec2i(x, y)) > 0.0 { return false; }
    }
  }
  return true;
}

// Whether the depths on both sides of `here` are nearly collinear with it: a fold passes, a step
// does not.
fn is_straight(texel: vec2i, side: vec2i, here: f32) -> bool {
  let before = depth_at(texel - side);
  let after = depth_at(texel + side);
  return min(before, after) > 0.0 && abs(before + after - 2.0 * here) <= DEPTH_BEND * here;
}

// Whether the surface goes on at a distance on all sides; what is between is not tested.
fn goes_on(texel: vec2i, far_px: i32, here: f32) -> bool {
  return is_straight(texel, vec2i(far_px, 0), here) && is_straight(texel, vec2i(0, far_px), here)
    && is_straight(texel, vec2i(far_px, far_px), here) && is_straight(texel, vec2i(far_px, -far_px), here);
}

// Weight of a single surface of the toy in a pixel: 0, MIXED, or 1. The distance is the spread's largest, also
// across a motion.
fn one_surface(texel: vec2i) -> f32 {
  let here = depth_at(texel);
  if here == 0.0 || !goes_on(texel, 1, here) { return 0.0; }
  if soft_px == 0 { return 1.0; }
  let is_unmixed = goes_on(texel, soft_px, here) && goes_on(texel, max(soft_px / 2, 1), here);
  return select(MIXED, 1.0, is_unmixed);
}

@fragment
fn fs_mark(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let is_clear = is_clear_of_toy(texel);
  let clear = select(vec2f(0.0), vec2f(1.0), vec2<bool>(is_clear, is_clear && is_well_clear_of_toy(texel)));
  return vec4f(clear.x, one_surface(texel), clear.y, 1.0);
}
