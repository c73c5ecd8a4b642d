// The toy over things before it whose top is known, such as a hand on the table: for a camera above that
// top, a part of the toy that is higher is in front of them. At a thing's rim all of the toy is drawn.

//#import common/marks

// Whether a pixel shows a thing before the toy, and nothing else.
fn is_all_before_toy(region_texel: vec2i) -> bool {
  let marks = marks_at(region_texel);
  return is_before_toy(marks) && all(rim_steps(marks) == vec4i(0));
}

// Whether a thing hides a point of the toy at this height above the first receiver.
fn is_below_top(region_texel: vec2i, height_m: f32) -> bool {
  return globals.things_top_m > 0.0 && height_m <= globals.things_top_m && is_all_before_toy(region_texel);
}
