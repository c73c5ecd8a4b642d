// Marks of the validity mask, which covers the physical box: all other pixels show the receiver,
// well clear of the toy.

//#import common/globals

const FAR_MARKS = vec4f(1.0, 0.0, 1.0, 1.0);
// Alpha of the marks of a thing, and of one before the toy: codes 204 and 153.
const THING: f32 = 0.8;
const BEFORE_TOY: f32 = 0.6;
// Taken off if it is before another thing, such as a person before a book: codes 102 and 51.
const BEFORE_THING: f32 = 0.4;
// Half of a code, beyond which alphas differ.
const TELLS_THINGS: f32 = 0.002;
// Codes above these of a pixel at the rim of a thing, which may mix it with what is behind it: one
// for each direction in which the thing ends, first for pixels outside its marks, then for those
// inside them.
const N_DIRECTIONS: u32 = 8u;
const MOST_RIM: f32 = 16.0 / 255.0;

fn marks_at(region_texel: vec2i) -> vec4f {
  let texel = physical_texel(region_texel);
  if !is_in_physical_box(texel) { return FAR_MARKS; }
  return textureLoad(validity, texel, 0);
}

// Whether alpha is this one or one of its rim, or this one before another thing.
fn is_alpha(marks: vec4f, alpha: f32) -> bool {
  let above = select(marks.a, marks.a + BEFORE_THING, marks.a < alpha - TELLS_THINGS) - alpha;
  return above > -TELLS_THINGS && above < MOST_RIM + TELLS_THINGS;
}

fn is_before_toy(marks: vec4f) -> bool {
  return is_alpha(marks, BEFORE_TOY);
}

fn is_thing(marks: vec4f) -> bool {
  return is_alpha(marks, THING) || is_before_toy(marks);
}

// Whether a thing hides another one.
fn is_before_thing(marks: vec4f) -> bool {
  return is_thing(marks) && marks.a < 0.5 * (THING - BEFORE_THING + BEFORE_TOY);
}

// Steps from a pixel at the rim of a thing, on either side of the end of its marks, to one that shows
// the thing alone, and to one beyond it.
fn rim_steps_of(outward: vec2i, is_inside: bool) -> vec4i {
  return vec4i(-select(2, 1, is_inside) * outward, select(1, 2, is_inside) * outward);
}

// The same for a pixel's marks; 0 if it is not at a rim.
fn rim_steps(marks: vec4f) -> vec4i {
  if !is_thing(marks) || is_before_thing(marks) { return vec4i(0); }
  let code = u32(round(255.0 * (marks.a - select(THING, BEFORE_TOY, is_before_toy(marks)))));
  if code == 0u { return vec4i(0); }
  let number = (code - 1u) % N_DIRECTIONS;
  // The fifth of nine neighbours is the pixel itself.
  let neighbor = i32(number + select(0u, 1u, number > 3u));
  return rim_steps_of(vec2i(neighbor % 3, neighbor / 3) - 1, code > N_DIRECTIONS);
}

// The same for a pixel of the region; 0 if something else hides what is beyond.
fn rim_steps_at(region_texel: vec2i) -> vec4i {
  let steps = rim_steps(marks_at(region_texel));
  if all(steps == vec4i(0)) { return steps; }
  return select(steps, vec4i(0), is_before_toy(marks_at(region_texel + steps.zw)));
}
