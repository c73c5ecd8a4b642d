// The background of a soft outline.
//
// A blurred picture mixes the toy with the background that it leaves free. The mean of the softened
// plate is over all positions of the spread, so that it also has what the toy hides. Therefore the plate
// is taken at the middle of the free positions. These lack the spread of `soft_texel`'s means, so that the
// middle is up to a quarter too near where the spread is only one pixel.
// The importing shader declares `plate`, and those of `drawn_toy` and `stillness`.

//#import common/drawn_toy
//#import common/fit
//#import common/globals
//#import common/marks
//#import common/spread
//#import common/stillness

// The change of the plate at a pixel of a soft outline, `plate_change`; 0 elsewhere.
var<private> beyond: vec3f = vec3f(0.0);

// Rows from one column's position to the next in the lattice of `coverage`.
const OUTLINE_ROW_STEP: u32 = 9u;

// The plate's colour between four texels, `at` texels from the middle of the region's first, and their
// least alpha.
fn plate_between(at: vec2f) -> vec4f {
  let low = floor(at);
  let t = at - low;
  let last = vec2i(globals.region_size_px) - 1;
  var sum = vec3f(0.0);
  var least = 1.0;
  for (var k = 0u; k < 4u; k++) {
    let corner = vec2f(vec2u(k & 1u, k >> 1u));
    let weight = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
    let one = textureLoad(plate, clamp(vec2i(low + corner), vec2i(0), last), 0);
    sum += weight * one.rgb;
    least = min(least, one.a);
  }
  return vec4f(sum, least);
}

// Middle of the positions around a texel of the toy box that the toy leaves free, in pixels from its own.
fn middle_of_free_px(in_box: vec2i, n_draws: u32) -> vec2f {
  var sum = vec3f(0.0);
  for (var k = 0u; k < N_POSITIONS; k++) {
    let lattice = vec2f(vec2u(k, k * OUTLINE_ROW_STEP % N_POSITIONS)) + 0.5;
    let from_px = spread_position_px(lattice / f32(N_POSITIONS));
    let tap = clamped_to_box(in_box + vec2i(floor(from_px + 0.5)));
    sum += (1.0 - drawn_toy(tap, n_draws).a) * vec3f(from_px, 1.0);
  }
  return select(vec2f(0.0), sum.xy / sum.z, sum.z > 0.0);
}

// Change of the photograph's plate from a texel of the region to the part that the toy leaves free. 0 where
// plates do not show both.
fn plate_change(texel: vec2i, n_draws: u32) -> vec3f {
  let own = textureLoad(plate, texel, 0);
  if own.a < 1.0 { return vec3f(0.0); }
  let free = plate_between(vec2f(texel) + middle_of_free_px(box_texel(texel), n_draws));
  return select(vec3f(0.0), fit.gain.rgb * (free.rgb - own.rgb), free.a == 1.0);
}

// Sets the change of the plate at a texel of the toy box, of which the toy covers `part`. It stays 0 at an
// outline that stands still, where the camera's pixels are shown unless the shadow there changes.
fn find_beyond(texel: vec2i, part: f32, evident: vec4f, has_moved: bool, n_draws: u32) {
  if part == 0.0 || !is_soft() || is_thing(evident) { return; }
  let in_box = box_texel(texel);
  let is_kept = evident.r == 0.0 && evident.a == 1.0 && !has_moved;
  if is_kept && stillness(in_box, moved_part(in_box)) == 1.0 { return; }
  beyond = plate_change(texel, n_draws);
}
