// The shown toy as drawn, once or four times: a pixel's colour and its coverage.
//
// The importing shader declares `toy_0` to `toy_3`, `covered` and `validity`.

//#import common/covered
//#import common/over_things
//#import common/soft_toy

// The toy's part of a pixel within a thing from which on the toy is over the thing's rim.
const OVER_RIM: f32 = 0.5;

fn drawn_toy(texel: vec2i, n_draws: u32) -> vec4f {
  let first = textureLoad(toy_0, texel, 0);
  if n_draws == 1u { return first; }
  return (first + textureLoad(toy_1, texel, 0) + textureLoad(toy_2, texel, 0) + textureLoad(toy_3, texel, 0)) / 4.0;
}

// Part of a pixel that the toy covers.
fn coverage(texel: vec2i) -> f32 {
  let n_covered = soft_texel(covered, texel).r / COVERED_POSITION;
  // These are whole numbers, except for their means.
  return select(round(n_covered), min(n_covered, f32(N_POSITIONS)), globals.soft_side > 0.0) / f32(N_POSITIONS);
}

// The toy's colour in a pixel: that of its draws or, if they miss its small part, that of its
// neighbours.
fn toy_color(texel: vec2i, n_draws: u32) -> vec4f {
  var own = drawn_toy(texel, n_draws);
  if own.a > 0.0 && is_soft() { own = softened_toy(texel, own, n_draws); }
  if own.a > 0.0 { return vec4f(own.rgb / own.a, 1.0); }
  var sum = vec4f(0.0);
  for (var y = -1; y <= 1; y++) {
    for (var x = -1; x <= 1; x++) {
      sum += drawn_toy(clamped_to_box(texel + vec2i(x, y)), n_draws);
    }
  }
  if sum.a == 0.0 && is_soft() { sum = toy_color_beyond(texel, n_draws); }
  if sum.a == 0.0 { return vec4f(0.0); }
  return vec4f(sum.rgb / sum.a, 1.0);
}

// The toy over its background: premultiplied colour, and its coverage.
fn toy_layer(texel: vec2i, n_draws: u32) -> vec4f {
  if !is_in_toy_box(texel) { return vec4f(0.0); }
  let part = coverage(texel);
  if part == 0.0 { return vec4f(0.0); }
  return part * toy_color(texel, n_draws);
}

// The same over a thing that is before the toy. At the thing's rim it is that at a pixel within the thing, to
// which `inward` leads.
fn over_thing(region_texel: vec2i, inward: vec2i, n_draws: u32) -> vec4f {
  if !has_front() || !is_before_toy(marks_at(region_texel)) { return vec4f(0.0); }
  let place = select(region_texel + inward, region_texel, is_front_alone(region_texel));
  let in_box = box_texel(place);
  // What is behind the fronts is drawn at the rim beside it.
  if !is_in_toy_box(in_box) || textureLoad(covered, in_box, 0).r == 0.0 { return vec4f(0.0); }
  return toy_layer(in_box, n_draws);
}
