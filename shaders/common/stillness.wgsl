// Part of a pixel in which the toy agrees with the camera's picture.
//
// The importing shader declares `toy_moved` and `moved_mask`.

//#import common/globals
//#import common/moved
//#import common/soft_toy

// Part of a texel of the toy box in which a surface has moved, in either pose.
fn moved_at(texel: vec2i) -> f32 {
  let clamped = clamped_to_box(texel);
  return max(moved_of(textureLoad(toy_moved, clamped, 0).r), textureLoad(moved_mask, clamped, 0).r);
}

// The largest moved part of a texel of the toy box, its four neighbours and, in a soft picture, the
// texels within its spread.
fn moved_part(texel: vec2i) -> f32 {
  let beside = max(moved_at(texel - vec2i(1, 0)), moved_at(texel + vec2i(1, 0)));
  let above_and_below = max(moved_at(texel - vec2i(0, 1)), moved_at(texel + vec2i(0, 1)));
  let most = max(moved_at(texel), max(beside, above_and_below));
  if most == 1.0 || !is_soft() { return most; }
  return max(most, moved_around(texel));
}

// 1 if a texel of the toy box, whose moved part is `moved`, agrees with the camera's picture in its
// light, too. A still surface in other light mixes nothing into its neighbours that they do not have.
fn stillness(texel: vec2i, moved: f32) -> f32 {
  return 1.0 - max(moved, changed_of(textureLoad(toy_moved, clamped_to_box(texel), 0).r));
}
