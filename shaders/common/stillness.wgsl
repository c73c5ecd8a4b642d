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

// 1 if a texel of the toy box shows the same light, and it and its four neighbours the same surfaces
// as the camera's picture. A still surface in other light mixes nothing into its neighbours that
// they do not have.
fn stillness(texel: vec2i) -> f32 {
  let beside = max(moved_at(texel - vec2i(1, 0)), moved_at(texel + vec2i(1, 0)));
  let above_and_below = max(moved_at(texel - vec2i(0, 1)), moved_at(texel + vec2i(0, 1)));
  let moved = max(moved_at(texel), max(beside, above_and_below));
  let most = max(moved, changed_of(textureLoad(toy_moved, clamped_to_box(texel), 0).r));
  if most == 1.0 || !is_soft() { return 1.0 - most; }
  return 1.0 - max(most, moved_around(texel));
}
