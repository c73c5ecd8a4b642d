// Appearance of the toy in a soft picture, beyond its drawn pixels.
//
// The importing shader declares `drawn_toy` and `moved_at`.

//#import common/globals
//#import common/spread

// Number of rings around a pixel in which the toy is searched for.
const N_RINGS: u32 = 4u;
// Positions along a line, as many as on both rings. In five captures of motions by 5 px the toy's error is
// 0 to 4 % less than with the rings; out of focus it is 2.30 codes in place of 2.21.
const N_ON_LINE: u32 = 24u;
const LINE_ROW_STEP: u32 = 7u;
// Rings for the toy's colours: their radii in standard deviations of the picture's spread, and the weights
// of their positions relative to the centre. Together they have 95 % of its variance. With radii of (0.6, 1.2)
// and weights of (1, 0.7) the toy's error is 5.77 codes for a llama in a known motion of 5 px,
// with these 4.68.
const NEAR_RINGS = vec2f(0.9, 2.0);
const NEAR_WEIGHTS = vec2f(1.0, 0.6);

// Sum of the toy's colours around a texel, from the nearest ring on which it is drawn.
fn toy_color_beyond(texel: vec2i, n_draws: u32) -> vec4f {
  var sum = vec4f(0.0);
  for (var ring = 1u; ring <= N_RINGS; ring++) {
    let reach_px = 1.0 + soft_reach_px() * f32(ring) / f32(N_RINGS);
    for (var k = 0u; k < N_ON_RING; k++) { sum += drawn_toy(clamped_to_box(on_ring(texel, reach_px, k)), n_draws); }
    if sum.a > 0.0 { break; }
  }
  return sum;
}

// The toy's colour at a drawn texel, premultiplied, as soft as the picture. It is drawn sharp: what the picture
// mixes into its colours is unmixed.
fn softened_toy(texel: vec2i, own: vec4f, n_draws: u32) -> vec4f {
  var sum = own;
  if globals.is_line == 1u {
    for (var k = 0u; k < N_ON_LINE; k++) {
      let lattice = (vec2f(vec2u(k, k * LINE_ROW_STEP % N_ON_LINE)) + 0.5) / f32(N_ON_LINE);
      let tap = clamped_to_box(texel + vec2i(floor(spread_position_px(lattice) + 0.5)));
      sum += drawn_toy(tap, n_draws);
    }
    return sum / sum.a;
  }
  for (var ring = 0u; ring < 2u; ring++) {
    for (var k = 0u; k < N_ON_RING; k++) {
      let turn = f32(k) * (TURN / f32(N_ON_RING));
      let offset_px = NEAR_RINGS[ring] * spread_px(vec2f(cos(turn), sin(turn)));
      let tap = clamped_to_box(texel + vec2i(round(offset_px)));
      sum += NEAR_WEIGHTS[ring] * drawn_toy(tap, n_draws);
    }
  }
  return sum / sum.a;
}

// The largest moved part around a texel, within its spread.
fn moved_around(texel: vec2i) -> f32 {
  var most = 0.0;
  for (var k = 0u; k < N_ON_RING; k++) {
    most = max(most, moved_at(on_ring(texel, 0.5 * soft_reach_px(), k)));
    most = max(most, moved_at(on_ring(texel, soft_reach_px(), k)));
  }
  return most;
}
