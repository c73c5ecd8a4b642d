// Things beside the toy, in the validity mask and in the plate.
//
// A thing gives no information on the light of a receiver, nor on the toy that it hides. It stays
// as photographed.
// A wrong part of the plate is treated as not photographed; a shadow that the plate alone has is
// divided out, and a thing that the toy hides gets the light of its visible part, or its colours if the plate
// does not show it.
//
// Reads: validity, marks of things, which belong to the picture in which they were found and are
// transferred by the first receiver's plane.
// Writes: the same mask, but r is 0 on a thing, and b is 1 if its pixel is clear of the toy; a is
// THING or BEFORE_TOY, for which g is 0 as well, less BEFORE_THING on a pixel of another thing. The plate's colour and alpha are multiplied: by 0
// in a wrong part.
// CPU reference: tests/reference/src/things.rs.

//#import common/fullscreen
//#import common/marks
//#import common/thing_marks

@group(1) @binding(2) var validity: texture_2d<f32>;

// Distance from a thing before the toy up to which a pixel of the toy mixes with it.
const MIXED_PX: f32 = 2.0;
// Smallest light in a plate: that of code 1.
const LEAST_LEFT: f32 = 0.00392;

fn code_at(region_px: vec2f) -> u32 {
  return code_of(mark_at(region_px));
}

fn is_beside_thing_before_toy(region_px: vec2f) -> bool {
  for (var y = -1.0; y <= 1.0; y += 1.0) {
    for (var x = -1.0; x <= 1.0; x += 1.0) {
      if code_at(region_px + MIXED_PX * vec2f(x, y)) == CODE_BEFORE_TOY { return true; }
    }
  }
  return false;
}

@fragment
fn fs_mark(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let marks = textureLoad(validity, vec2u(position.xy), 0);
  let code = code_at(position.xy);
  // A pixel that is marked already is evidence of nothing: its own mark tells whether it is clear.
  let is_second = is_thing(marks);
  let clear = select(marks.r, marks.b, is_second);
  let less = select(0.0, BEFORE_THING, is_second);
  if code == CODE_BEFORE_TOY { return vec4f(0.0, 0.0, clear, BEFORE_TOY - less); }
  var of_toy = marks.g;
  if of_toy > 0.0 && is_beside_thing_before_toy(position.xy) { of_toy = 0.0; }
  if code == CODE_THING || code == CODE_HIDDEN_THING || code == CODE_PAINTED_THING {
    return vec4f(0.0, of_toy, clear, THING - less);
  }
  return vec4f(marks.r, of_toy, marks.ba);
}

// Factors of the plate's colour and alpha.
@fragment
fn fs_correct_plate(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let mark = mark_at(position.xy);
  let code = code_of(mark);
  if code == CODE_WRONG_PLATE { return vec4f(0.0); }
  if code == CODE_SHADED_PLATE { return vec4f(1.0 / max(mark.gba, vec3f(LEAST_LEFT)), 1.0); }
  if code == CODE_HIDDEN_THING { return vec4f(mark.gba, 1.0); }
  if code == CODE_PAINTED_THING { return vec4f(MOST_PAINTED * mark.gba * mark.gba, 1.0); }
  return vec4f(1.0);
}
