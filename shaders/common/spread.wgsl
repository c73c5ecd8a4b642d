// Positions that a pixel is drawn for in a picture that is softer than pixels are: spread as the picture spreads a point.
//
// So shadows and outlines are drawn as soft as the picture shows them, for no more than it takes to draw them sharp.

//#import common/globals

// Whether the picture is seen to be softer than pixels are.
fn is_soft() -> bool {
  return globals.spread.x > 0.0;
}

// Farthest that a position lies from the pixel's centre, and what the picture shows is spread.
fn soft_reach_px() -> f32 {
  return globals.spread.w;
}

const PI: f32 = 3.14159265;
const WINITZKI: f32 = 0.147;

// The mean of what was drawn by spread positions in a texel and in those around it: of nine times as many positions.
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

// What a number of a normal distribution is above, by the part of all numbers that are below, to 2 parts in 1000.
// Source: Winitzki 2008 (the inverse error function).
fn normal_quantile(part: f32) -> f32 {
  let x = 2.0 * part - 1.0;
  let l = log(1.0 - x * x);
  let t = 2.0 / (PI * WINITZKI) + 0.5 * l;
  return sign(x) * sqrt(2.0 * (sqrt(t * t - l / WINITZKI) - t));
}

// Offset from a pixel's centre, in pixels, of a position of an even lattice over the square from 0 to 1, both left out.
fn spread_position_px(lattice: vec2f) -> vec2f {
  let normal = vec2f(normal_quantile(lattice.x), normal_quantile(lattice.y));
  return spread_px(normal);
}

// A place in standard deviations of the spread, in pixels.
fn spread_px(deviations: vec2f) -> vec2f {
  return vec2f(globals.spread.x * deviations.x, globals.spread.y * deviations.x + globals.spread.z * deviations.y);
}
