// Borders of special pixels: at the region's edge, and beside a toy that has moved.
//
// The importing shader declares `moved_mask`.

//#import common/globals

// Distance up to which a moved toy's colours are looked for beside a pixel.
const MOVED_BESIDE_PX: f32 = 6.0;

// 1 inside, falling to 0 at an inner border of the region.
fn inside_border(region_px: vec2f) -> f32 {
  let to_edge = vec4f(region_px, globals.region_size_px - region_px);
  let fade = select(vec4f(1.0), to_edge / globals.border_px, globals.border_px > vec4f(0.0));
  return saturate(min(min(fade.x, fade.y), min(fade.z, fade.w)));
}

// Whether the toy's surface beside this texel of the toy box has moved. There is none near the
// border of the box, unless that is the region's.
fn has_moved_beside(texel: vec2i) -> bool {
  var most = 0.0;
  for (var k = 0u; k < 16u; k++) {
    let turn = f32(k) * 0.78539816;
    let reach_px = select(MOVED_BESIDE_PX, 0.5 * MOVED_BESIDE_PX, k < 8u);
    let tap = texel + vec2i(round(reach_px * vec2f(cos(turn), sin(turn))));
    most = max(most, textureLoad(moved_mask, clamped_to_box(tap), 0).r);
  }
  return most > 0.0;
}
