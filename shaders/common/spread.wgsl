// Positions within a pixel in a picture that is softer than its pixels: they have the picture's
// spread of a point.
//
// In this way soft shadows and outlines cost no more than sharp ones.

//#import common/globals

// Whether the picture is softer than its pixels.
fn is_soft() -> bool {
  return globals.soft_reach_px > 0.0;
}

// Largest distance of a position from the pixel's centre, over which the picture spreads its
// content.
fn soft_reach_px() -> f32 {
  return globals.soft_reach_px;
}

const PI: f32 = 3.14159265;
const WINITZKI: f32 = 0.147;
// Half a line's length over its standard deviation.
const ROOT_3: f32 = 1.7320508;

// The mean over a texel and its neighbours, which were drawn with spread positions: it has nine
// times as many positions.
fn soft_texel(map: texture_2d<f32>, texel: vec2i) -> vec4f {
  let side = globals.soft_side;
  if side == 0.0 { return textureLoad(map, texel, 0); }
  let last = vec2i(textureDimensions(map)) - 1;
  var sum = vec4f(0.0);
  for (var y = -1; y <= 1; y++) {
    for (var x = -1; x <= 1; x++) {
      let weight = select(side, 1.0 - 2.0 * side, x == 0) * select(side, 1.0 - 2.0 * side, y == 0);
      sum += weight * textureLoad(map, clamp(texel + vec2i(x, y), vec2i(0), last), 0);
    }
  }
  return sum;
}

// Quantile of the normal distribution for the given part of all numbers, to 2 parts in 1000.
// Source: Winitzki 2008 (the inverse error function).
fn normal_quantile(part: f32) -> f32 {
  let x = 2.0 * part - 1.0;
  let l = log(1.0 - x * x);
  let t = 2.0 / (PI * WINITZKI) + 0.5 * l;
  return sign(x) * sqrt(2.0 * (sqrt(t * t - l / WINITZKI) - t));
}

// Offset of a position from a pixel's centre, in pixels, for a position of an even lattice over the
// open square from 0 to 1.
fn spread_position_px(lattice: vec2f) -> vec2f {
  let along = select(normal_quantile(lattice.x), ROOT_3 * (2.0 * lattice.x - 1.0), globals.is_line == 1u);
  return spread_px(vec2f(along, normal_quantile(lattice.y)));
}

// The distance over which `soft_texel`'s mean would spread the position with this number.
fn beside_px(k: u32) -> vec2f {
  return sqrt(2.0 * globals.soft_side) * (2.0 * vec2f(vec2u(k, k >> 1u) & vec2u(1u)) - 1.0);
}

// Converts standard deviations of the spread to pixels.
fn spread_px(deviations: vec2f) -> vec2f {
  return globals.spread.xy * deviations.x + globals.spread.zw * deviations.y;
}

// Positions on a ring around a pixel.
const N_ON_RING: u32 = 12u;
const TURN: f32 = 6.2831853;

fn on_ring(texel: vec2i, reach_px: f32, k: u32) -> vec2i {
  let turn = f32(k) * (TURN / f32(N_ON_RING));
  return texel + vec2i(round(reach_px * vec2f(cos(turn), sin(turn))));
}
