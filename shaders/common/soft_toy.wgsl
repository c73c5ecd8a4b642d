// What a soft picture shows of the toy beside where it is drawn.
//
// Of the shader that imports it are `drawn_toy` and `change_at`.

//#import common/globals
//#import common/spread

// Rings around a pixel on which a toy is looked for, and places on each.
const N_RINGS: u32 = 4u;
const N_ON_RING: u32 = 12u;
const TURN: f32 = 6.2831853;
// Rings on which colours of what has moved are taken, nearest first: their radii in deviations of the picture's spread, and weights of their
// places against that of the middle.
const NEAR_RINGS = vec2f(0.6, 1.2);
const NEAR_WEIGHTS = vec2f(0.6, 0.25);

fn on_ring(texel: vec2i, reach_px: f32, k: u32) -> vec2i {
  let turn = f32(k) * (TURN / f32(N_ON_RING));
  return texel + vec2i(round(reach_px * vec2f(cos(turn), sin(turn))));
}

// Sum of the toy's colours around a texel, from as near as it is drawn.
fn toy_color_beyond(texel: vec2i, n_draws: u32) -> vec4f {
  var sum = vec4f(0.0);
  for (var ring = 1u; ring <= N_RINGS; ring++) {
    let reach_px = 1.0 + soft_reach_px() * f32(ring) / f32(N_RINGS);
    for (var k = 0u; k < N_ON_RING; k++) { sum += drawn_toy(clamped_to_box(on_ring(texel, reach_px, k)), n_draws); }
    if sum.a > 0.0 { break; }
  }
  return sum;
}

// The toy's colour at a texel where it is drawn, premultiplied. What has moved is about as soft as the picture: folds between its parts, and
// what no camera has seen, are drawn sharp.
fn softened_toy(texel: vec2i, own: vec4f, n_draws: u32) -> vec4f {
  let change = change_at(texel);
  if change == 0.0 { return own; }
  var sum = own;
  for (var ring = 0u; ring < 2u; ring++) {
    for (var k = 0u; k < N_ON_RING; k++) {
      let turn = f32(k) * (TURN / f32(N_ON_RING));
      let offset_px = NEAR_RINGS[ring] * spread_px(vec2f(cos(turn), sin(turn)));
      let tap = clamped_to_box(texel + vec2i(round(offset_px)));
      sum += NEAR_WEIGHTS[ring] * drawn_toy(tap, n_draws);
    }
  }
  return mix(own / own.a, sum / sum.a, change);
}

// The most change around a texel, as far as it is spread.
fn change_around(texel: vec2i) -> f32 {
  var most = 0.0;
  for (var k = 0u; k < N_ON_RING; k++) {
    most = max(most, change_at(on_ring(texel, 0.5 * soft_reach_px(), k)));
    most = max(most, change_at(on_ring(texel, soft_reach_px(), k)));
  }
  return most;
}
