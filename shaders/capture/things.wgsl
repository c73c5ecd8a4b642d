// Things beside the toy, in the validity mask and in the plate.
//
// A thing gives no information on the light of a receiver, nor on the toy that it hides. It stays
// as photographed.
// A wrong part of the plate is treated as not photographed.
//
// Reads: validity, marks of things, which belong to the picture in which they were found and are
// transferred by the first receiver's plane.
// Writes: the same mask, but r is 0 on a thing, and b is 1 if its pixel is clear of the toy; a is
// THING or BEFORE_TOY, for which g is 0 as well. In the plate alpha alone: 0 in a wrong part.
// CPU reference: tests/reference/src/things.rs.

//#import common/fullscreen
//#import common/marks

struct ThingsView {
  // Homography to the marks' pixels: (u, v, w) for a pixel of the region, with w > 0 in front of
  // their camera.
  marks_px_from_region_px: mat3x3f,
}

@group(1) @binding(0) var<uniform> things: ThingsView;
// Codes of marks.
@group(1) @binding(1) var codes: texture_2d<f32>;
@group(1) @binding(2) var validity: texture_2d<f32>;

const CODE_THING: u32 = 1u;
const CODE_BEFORE_TOY: u32 = 2u;
const CODE_WRONG_PLATE: u32 = 3u;
// Distance from a thing before the toy up to which a pixel of the toy mixes with it.
const MIXED_PX: f32 = 2.0;

fn code_at(region_px: vec2f) -> u32 {
  let at = things.marks_px_from_region_px * vec3f(region_px, 1.0);
  if at.z <= 0.0 { return 0u; }
  let texel = vec2i(floor(at.xy / at.z));
  if any(texel < vec2i(0)) || any(texel >= vec2i(textureDimensions(codes))) { return 0u; }
  return u32(round(255.0 * textureLoad(codes, texel, 0).r));
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
  if code == CODE_BEFORE_TOY { return vec4f(0.0, 0.0, marks.r, BEFORE_TOY); }
  var of_toy = marks.g;
  if of_toy == 1.0 && is_beside_thing_before_toy(position.xy) { of_toy = 0.0; }
  if code == CODE_THING { return vec4f(0.0, of_toy, marks.r, THING); }
  return vec4f(marks.r, of_toy, marks.ba);
}

@fragment
fn fs_forget_plate(@builtin(position) position: vec4f) -> @location(0) vec4f {
  if code_at(position.xy) != CODE_WRONG_PLATE { discard; }
  return vec4f(0.0);
}
