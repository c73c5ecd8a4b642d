// Marks of the validity mask, which covers the physical box: all other pixels show the receiver,
// well clear of the toy.

//#import common/globals

const FAR_MARKS = vec4f(1.0, 0.0, 1.0, 1.0);
// Alpha of the marks of a thing, and of one before the toy: codes 204 and 153.
const THING: f32 = 0.8;
const BEFORE_TOY: f32 = 0.6;
// A quarter of their difference.
const TELLS_THINGS: f32 = 0.05;

fn marks_at(region_texel: vec2i) -> vec4f {
  let texel = physical_texel(region_texel);
  if !is_in_physical_box(texel) { return FAR_MARKS; }
  return textureLoad(validity, texel, 0);
}

fn is_before_toy(marks: vec4f) -> bool {
  return abs(marks.a - BEFORE_TOY) < TELLS_THINGS;
}

fn is_thing(marks: vec4f) -> bool {
  return abs(marks.a - THING) < TELLS_THINGS || is_before_toy(marks);
}
