// Marks of the validity mask, which covers the physical box: all other pixels show the receiver,
// well clear of the toy.

//#import common/globals

const FAR_MARKS = vec4f(1.0, 0.0, 1.0, 1.0);
// Alpha of the marks of a thing, and of one before the toy: codes 204 and 153.
const THING: f32 = 0.8;
const BEFORE_TOY: f32 = 0.6;
// Taken off if it is before another thing, such as a person before a book: codes 102 and 51.
const BEFORE_THING: f32 = 0.4;
// A quarter of the difference of the former.
const TELLS_THINGS: f32 = 0.05;

fn marks_at(region_texel: vec2i) -> vec4f {
  let texel = physical_texel(region_texel);
  if !is_in_physical_box(texel) { return FAR_MARKS; }
  return textureLoad(validity, texel, 0);
}

// Whether alpha is this one, or this one before another thing.
fn is_alpha(marks: vec4f, alpha: f32) -> bool {
  return min(abs(marks.a - alpha), abs(marks.a + BEFORE_THING - alpha)) < TELLS_THINGS;
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
