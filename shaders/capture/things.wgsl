// Things that stand in the picture beside the toy, in the validity mask and in the plate.
//
// A thing tells nothing of the light on a receiver, nor of the toy that it hides. What it shows stays.
// Where the plate is wrong it is as if none had been photographed.
//
// Reads: validity, marks of things, which are of the picture that they were found in and are carried over by the first receiver's plane.
// Writes: the same mask, but r is 0 on a thing, and b is 1 where its pixel is clear of the toy; a is THING or BEFORE_TOY, where g is 0
// as well. Of the plate alpha alone: 0 where it is wrong.
// CPU reference: tests/reference/src/things.rs.

//#import common/fullscreen
//#import common/marks

struct ThingsView {
  // Homography: (u, v, w) in the marks' pixels of a pixel of the region, w > 0 before their camera.
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
