// The background of a soft outline.
//
// A blurred picture mixes the toy with the background that it leaves free. The means of the softened
// plate and of the lights' visibility are over all positions of the spread, so that they also have what
// the toy hides, such as its shadow behind its foot. Therefore both are taken at the middle of the free
// positions. These lack the spread of `soft_texel`'s means, so that the middle is up to a quarter too
// near where the spread is only one pixel.
// The importing shader declares `plate`, `visibility`, and those of `drawn_toy` and `stillness`.

//#import common/drawn_toy
//#import common/fit
//#import common/globals
//#import common/marks
//#import common/pixel
//#import common/spread
//#import common/stillness
//#import common/unknown

// The change of the plate at a pixel of a soft outline, `plate_change`; 0 elsewhere.
var<private> beyond: vec3f = vec3f(0.0);
// Whether the pixel is one of such an outline, and the lights' visibilities beside the toy there.
var<private> is_beside: bool = false;
var<private> visibility_beside: vec4f = vec4f(0.0);
// Whether they are shown.
var<private> shows_beside: bool = false;

// Rows from one column's position to the next in the lattice of `coverage`.
const OUTLINE_ROW_STEP: u32 = 9u;

// One of the four texels of the region around a place, `at` texels from the middle of its first: the texel's
// place, and its weight.
fn around(at: vec2f, k: u32) -> vec3f {
  let low = floor(at);
  let t = at - low;
  let corner = vec2f(vec2u(k & 1u, k >> 1u));
  let weight = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
  return vec3f(clamp(low + corner, vec2f(0.0), globals.region_size_px - 1.0), weight);
}

// The plate's colour at a place between texels, and the least alpha of these.
fn plate_between(at: vec2f) -> vec4f {
  var sum = vec3f(0.0);
  var least = 1.0;
  for (var k = 0u; k < 4u; k++) {
    let near = around(at, k);
    let one = textureLoad(plate, vec2i(near.xy), 0);
    sum += near.z * one.rgb;
    least = min(least, one.a);
  }
  return vec4f(sum, least);
}

// The lights' visibilities there.
fn visibility_between(at: vec2f) -> vec4f {
  var sum = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let near = around(at, k);
    sum += near.z * soft_texel(visibility, vec2i(near.xy));
  }
  return sum;
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

// Change of the photograph's plate from a texel of the region to a place. 0 where plates do not show both.
fn plate_change(texel: vec2i, at: vec2f) -> vec3f {
  let own = textureLoad(plate, texel, 0);
  if own.a < 1.0 { return vec3f(0.0); }
  let free = plate_between(at);
  return select(vec3f(0.0), fit.gain.rgb * (free.rgb - own.rgb), free.a == 1.0);
}

// The lights' visibilities in the shown pose.
fn shown_visibility(texel: vec2i) -> vec4f {
  if shows_beside { return visibility_beside; }
  return soft_texel(visibility, texel);
}

// Sets what is beside the toy at a texel of the region, of which the toy covers `part`. Nothing is at an outline
// that stands still, where the camera's pixels are shown unless the shadow there changes.
fn find_beyond(texel: vec2i, part: f32, evident: vec4f, has_moved: bool, n_draws: u32) {
  if part == 0.0 || !is_soft() || is_thing(evident) { return; }
  let in_box = box_texel(texel);
  let is_kept = evident.r == 0.0 && evident.a == 1.0 && !has_moved;
  if is_kept && stillness(in_box, moved_part(in_box)) == 1.0 { return; }
  let at = vec2f(texel) + middle_of_free_px(in_box, n_draws);
  beyond = plate_change(texel, at);
  is_beside = true;
  visibility_beside = visibility_between(at);
}

// Part of a camera pixel that changes along an outline as the plate does, if its light is `off` that of the
// lit plate: an unmarked thing has none.
fn explained(off: vec3f, lit: vec3f) -> f32 {
  return 1.0 - outlier(off / max(lit + max(beyond, vec3f(0.0)), vec3f(DARKEST_USABLE)));
}
