// Pixels at the edge between two receivers, such as the edge of a book.
//
// Such a pixel shows both, so its model is the mean of theirs, weighted by their light in the plate,
// if they differ there: that tells how much of the pixel each has, also for an edge that is listed
// or found a part of a pixel off.
// The importing shader declares `plate`, `physical_visibility` and `visibility`.

//#import common/globals
//#import common/model
//#import common/relit
//#import common/spread

// Distance of the places around a pixel's centre at which the other receiver is looked for, along
// either axis, and of the pixels that show one alone. With .25, .75 and 1.2, and 2, 2 and 3 pixels,
// the RMS error of the shadow beside a book is .80, .82 and .85 codes if its top is listed, and 1.35,
// .99 and 1.17 if it is found.
const BESIDE_PX: f32 = 0.75;
const ALONE_PX: f32 = 2.0;
// Squared difference of two colours of the plate, over the square of one, from which it tells both
// apart.
const TELLS: f32 = 0.01;

// One of four places around a pixel's centre.
fn beside(k: u32) -> vec2f {
  return vec2f(f32(k & 1u), f32(k >> 1u)) * 2.0 - 1.0;
}

// Sum of the directions in which a receiver other than the one at a pixel's centre is near.
fn toward_other(at: vec2f) -> vec2f {
  let own = receiver_of(receiver_point(at));
  var sum = vec2f(0.0);
  for (var k = 0u; k < 4u; k++) {
    if receiver_of(receiver_point(at + BESIDE_PX * beside(k))) != own { sum += beside(k); }
  }
  return sum;
}

fn is_in_region(at: vec2f) -> bool {
  return all(at >= vec2f(0.0)) && all(at < globals.region_size_px);
}

// Part of a pixel's light in the plate that the other receiver has, which is seen alone `there`;
// `own` is the receiver at its centre. 0 if it is not known.
fn part_of_other(at: vec2f, there: vec2f, own: u32) -> vec3f {
  let here = 2.0 * at - there;
  if !is_in_region(there) || !is_in_region(here) { return vec3f(0.0); }
  if receiver_of(receiver_point(there)) == own || receiver_of(receiver_point(here)) != own { return vec3f(0.0); }
  let b_there = textureLoad(plate, vec2u(there), 0);
  let b_here = textureLoad(plate, vec2u(here), 0);
  if b_there.a == 0.0 || b_here.a == 0.0 || is_relit(b_there) || is_relit(b_here) { return vec3f(0.0); }
  let differs = b_there.rgb - b_here.rgb;
  let square = dot(differs, differs);
  if square <= TELLS * dot(b_there.rgb, b_there.rgb) { return vec3f(0.0); }
  let part = saturate(dot(textureLoad(plate, vec2u(at), 0).rgb - b_here.rgb, differs) / square);
  let other = part * b_there.rgb;
  let both = other + (1.0 - part) * b_here.rgb;
  return select(vec3f(0.0), other / both, both > vec3f(0.0));
}

// The models of the receiver at a pixel's centre, mixed with those of the other one beside it.
// Where that is none, nothing changes. The coarse ambient visibilities are of both already.
fn mixed_models(at: vec2f, own: u32, toward: vec2f, ambients: vec2f, models: mat2x3f) -> mat2x3f {
  if all(toward == vec2f(0.0)) { return models; }
  let there = at + ALONE_PX * sign(toward);
  let part = part_of_other(at, there, own);
  if all(part == vec3f(0.0)) { return models; }
  let point = receiver_point(there);
  var other = mat2x3f(vec3f(1.0), vec3f(1.0));
  if is_hit(point) {
    let before = soft_texel(physical_visibility, vec2i(there));
    let after = soft_texel(visibility, vec2i(there));
    other = receiver_models(point, ambients, before, after);
  }
  return mat2x3f(mix(models[0], other[0], part), mix(models[1], other[1], part));
}
