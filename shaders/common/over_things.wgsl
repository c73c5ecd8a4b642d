// The toy over things before it whose top is known, such as a hand on the table: for a camera above that
// top, a part of the toy that is higher is in front of them.
//
// The importing shader declares `validity`.

//#import common/marks

// Whether a pixel shows a thing before the toy, and nothing else.
fn is_all_before_toy(region_texel: vec2i) -> bool {
  return is_before_toy(marks_at(region_texel)) && all(rim_steps_at(region_texel) == vec4i(0));
}

// Whether the toy above the top alone is drawn at a pixel of a thing. At the rim of one, which mixes it with
// what is beyond it, all of the toy is, unless it is too thin to have a pixel of its own within.
fn is_top_alone(region_texel: vec2i) -> bool {
  if !is_before_toy(marks_at(region_texel)) { return false; }
  let steps = rim_steps_at(region_texel);
  return all(steps == vec4i(0)) || !is_all_before_toy(region_texel + steps.xy);
}

// Whether a thing hides a point of the toy at this height above the first receiver.
fn is_below_top(region_texel: vec2i, height_m: f32) -> bool {
  return globals.things_top_m > 0.0 && height_m <= globals.things_top_m && is_top_alone(region_texel);
}
