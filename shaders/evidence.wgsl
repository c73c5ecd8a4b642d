// Which pixels of the frame show what: r is 1 where it shows the receiver alone, g where it shows one surface of the toy.
//
// Pixels that mix two surfaces (an outline, camera blur, a pose half a pixel off) are evidence of neither.
// Reads: depth of the physical toy. Writes: r and g, 0 or 1.

@group(1) @binding(0) var object_depth: texture_depth_2d;

// Distance kept from the toy's outline on the receiver.
const EDGE_PX: i32 = 2;

fn depth_at(texel: vec2i) -> f32 {
  let last = vec2i(textureDimensions(object_depth)) - 1;
  return textureLoad(object_depth, clamp(texel, vec2i(0), last), 0);
}

fn is_clear_of_toy(texel: vec2i) -> bool {
  for (var y = -EDGE_PX; y <= EDGE_PX; y++) {
    for (var x = -EDGE_PX; x <= EDGE_PX; x++) {
      if depth_at(texel + vec2i(x, y)) > 0.0 { return false; }
    }
  }
  return true;
}

fn is_one_surface(texel: vec2i) -> bool {
  let here = depth_at(texel);
  if here == 0.0 { return false; }
  for (var y = -1; y <= 1; y++) {
    for (var x = -1; x <= 1; x++) {
      if !is_same_surface(here, depth_at(texel + vec2i(x, y))) { return false; }
    }
  }
  return true;
}

@fragment
fn fs_mark(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let shows_receiver = receiver_point(at.xy).is_hit && is_clear_of_toy(texel);
  return vec4f(select(0.0, 1.0, shows_receiver), select(0.0, 1.0, is_one_surface(texel)), 0.0, 1.0);
}
