// The toy over things before it whose fronts are known, such as the height of a hand on the table, or the side and the
// height of a post: for a camera before such a plane, a part of the toy there is in front of them.
//
// The importing shader declares `validity`.

//#import common/marks

// Whether a pixel shows a thing before the toy, and nothing else.
fn is_all_before_toy(region_texel: vec2i) -> bool {
  return is_before_toy(marks_at(region_texel)) && all(rim_steps_at(region_texel) == vec4i(0));
}

// Whether the toy before a front alone is drawn at a pixel of a thing. At the rim of one, which mixes it with
// what is beyond it, all of the toy is, unless it is too thin to have a pixel of its own within.
fn is_front_alone(region_texel: vec2i) -> bool {
  if !is_before_toy(marks_at(region_texel)) { return false; }
  let steps = rim_steps_at(region_texel);
  return all(steps == vec4i(0)) || !is_all_before_toy(region_texel + steps.xy);
}

// Whether things before the toy have a front.
fn has_front() -> bool {
  return any(globals.things_fronts[0] != vec4f(0.0));
}

// Distances in metres of a point of the toy from the fronts, negative behind them.
fn before_fronts_m(in_anchor: vec3f) -> vec2f {
  let point = vec4f(in_anchor, 1.0);
  return vec2f(dot(globals.things_fronts[0], point), dot(globals.things_fronts[1], point));
}

// Whether a thing hides a point of the toy at these distances from the fronts.
fn is_behind_thing(region_texel: vec2i, before_m: vec2f) -> bool {
  return has_front() && all(before_m <= vec2f(0.0)) && is_front_alone(region_texel);
}
