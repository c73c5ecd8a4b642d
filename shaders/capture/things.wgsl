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
// THING or BEFORE_TOY, for which g is 0 as well, less BEFORE_THING on a pixel of another thing, and
// one of 16 codes more at the thing's rim: the pixels on either side of the end of its marks. The
// plate's colour and alpha are multiplied: by 0 in a wrong part, and its alpha by that of an estimate where the
// receiver's pattern is known.
// CPU reference: tests/reference/src/things.rs.

//#import common/fullscreen
//#import common/estimated
//#import common/marks
//#import common/thing_marks

@group(1) @binding(2) var validity: texture_2d<f32>;

// Distance from a thing before the toy up to which a pixel of the toy mixes with it.
const MIXED_PX: f32 = 2.0;
// Distance of the pixels around one at a thing's rim that tell in which direction the thing ends, and
// the least part of that direction along an axis: the sine of half of 45 degrees.
const REACH_PX: i32 = 2;
const LEAST_PART: f32 = 0.3827;
// Whether the plate is made soft afterwards, which weighs colours by their alpha: an estimate's is multiplied by
// its own then.
override IS_SOFTENED: bool = false;
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

// Whether the frame shows a thing at a pixel of this code.
fn shows_thing(code: u32) -> bool {
  return code == CODE_THING || code == CODE_BEFORE_TOY;
}

// Direction out of a thing at a pixel beside the end of its marks, as a step to one of eight
// neighbours; 0 elsewhere.
fn outward(region_px: vec2f) -> vec2i {
  let here = shows_thing(code_at(region_px));
  var ends = false;
  var sum = vec2f(0.0);
  for (var y = -REACH_PX; y <= REACH_PX; y++) {
    for (var x = -REACH_PX; x <= REACH_PX; x++) {
      let step = vec2f(vec2i(x, y));
      let shows = shows_thing(code_at(region_px + step));
      ends = ends || (abs(x) + abs(y) == 1 && shows != here);
      sum += select(step, -step, shows) / max(dot(step, step), 1.0);
    }
  }
  let is_along = abs(sum) > vec2f(LEAST_PART * length(sum));
  return select(vec2i(0), select(vec2i(0), vec2i(sign(sum)), is_along), ends);
}

// The rim's code of a pixel over that of its thing's marks, and the thing's code; 0 if it is at none.
fn rim_code(region_px: vec2f) -> vec2u {
  let out = outward(region_px);
  if all(out == vec2i(0)) { return vec2u(0u); }
  let is_inside = shows_thing(code_at(region_px));
  let steps = rim_steps_of(out, is_inside);
  let within = region_px + vec2f(steps.xy);
  let inner = code_at(within);
  let beyond = region_px + vec2f(steps.zw);
  // Both are read, and the region ends here.
  let is_in = all(min(within, beyond) > vec2f(0.0)) && all(max(within, beyond) < vec2f(textureDimensions(validity)));
  if !is_in || !shows_thing(inner) || shows_thing(code_at(beyond)) { return vec2u(0u); }
  let neighbor = u32(3 * (out.y + 1) + out.x + 1);
  let number = neighbor - select(0u, 1u, neighbor > 4u);
  return vec2u(1u + number + select(0u, N_DIRECTIONS, is_inside), inner);
}

@fragment
fn fs_mark(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let marks = textureLoad(validity, vec2u(position.xy), 0);
  let code = code_at(position.xy);
  // A pixel that is marked already is evidence of nothing: its own mark tells whether it is clear.
  let is_second = is_thing(marks);
  let clear = select(marks.r, marks.b, is_second);
  let less = select(0.0, BEFORE_THING, is_second);
  let rim = select(rim_code(position.xy), vec2u(0u), is_second);
  let above = f32(rim.x) / 255.0;
  if code == CODE_BEFORE_TOY { return vec4f(0.0, 0.0, clear, BEFORE_TOY - less + above); }
  if rim.y == CODE_BEFORE_TOY { return vec4f(0.0, 0.0, marks.b, BEFORE_TOY + above); }
  var of_toy = marks.g;
  if of_toy > 0.0 && is_beside_thing_before_toy(position.xy) { of_toy = 0.0; }
  // A pixel that may mix with the toy over the thing is no rim.
  let of_rim = select(0.0, above, marks.r == 1.0);
  if code == CODE_THING || code == CODE_HIDDEN_THING || code == CODE_PAINTED_THING {
    return vec4f(0.0, of_toy, clear, THING - less + of_rim);
  }
  if of_rim > 0.0 { return vec4f(0.0, of_toy, marks.b, THING + of_rim); }
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
  // An estimate counts as such.
  if code == CODE_COMPLETED_PLATE {
    let weight = select(1.0, ESTIMATED, IS_SOFTENED);
    return vec4f(weight * MOST_COMPLETED * mark.gba * mark.gba, ESTIMATED);
  }
  return vec4f(1.0);
}
