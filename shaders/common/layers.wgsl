// The picture in layers: clean plate, shadow ratio, toy and masks.
//
// The importing shader declares `receiver`, `composed`, `drawing`, `visibility`, `ambient` and
// `linear_sampler`, and imports `thing_rim`.

//#import common/behind_outline
//#import common/drawn_toy
//#import common/frame
//#import common/marks

struct Layers {
  // The receiver without the shown shadow and the toy.
  @location(0) clean_plate: vec4f,
  // Ratio of the receiver with the shadow to the receiver without it.
  @location(1) shadow_ratio: vec4f,
  // Premultiplied toy, which gives the picture over the receiver; alpha is the toy's part of the
  // pixel.
  @location(2) toy: vec4f,
  // The toy's part of the pixel, the largest hidden part of a light, and whether there is a
  // receiver.
  @location(3) masks: vec4f,
}

// Light of a clean plate below which a ratio to it is noise.
const DARKEST_RATIO: f32 = 1e-3;

// The largest part of a light that the shown toy hides: of the ambient one, if no other is known.
fn most_hidden(at: vec2f) -> f32 {
  if has_no_light() {
    return 1.0 - textureSampleLevel(ambient, linear_sampler, at / globals.region_size_px, 0.0).r;
  }
  let hidden = 1.0 - soft_texel(visibility, vec2i(at));
  let is_light = vec4u(0u, 1u, 2u, 3u) < vec4u(globals.n_lights);
  let most = select(vec4f(0.0), hidden, is_light);
  return max(max(most.x, most.y), max(most.z, most.w));
}

// The layers in their order, as a matrix, since fragment shaders must not have structs as values.
fn layered(position: vec4f, n_draws: u32) -> mat4x4f {
  let texel = vec2i(position.xy);
  let f = frame_at(texel);
  let evident = marks_at(texel);
  let is_receiver = is_hit(receiver_point(position.xy));
  let masks = vec4f(0.0, 0.0, select(0.0, 1.0, is_receiver), 1.0);
  let in_box = box_texel(texel);
  let steps = rim_steps_at(texel);
  let is_at_end = any(steps != vec4i(0));
  let whole = composed(position, n_draws);
  let higher = over_thing(texel, steps.xy, n_draws);
  if is_at_end && higher.a > OVER_RIM {
    let toy = toy_layer(in_box, n_draws);
    let below = select(f, max((whole.rgb - toy.rgb) / (1.0 - toy.a), vec3f(0.0)), toy.a < 1.0);
    return mat4x4f(vec4f(below, 1.0), vec4f(1.0), toy, vec4f(toy.a, masks.yzw));
  }
  if !is_at_end && higher.a > 0.0 {
    return mat4x4f(vec4f(before_toy(texel, f), 1.0), vec4f(1.0), higher, vec4f(higher.a, masks.yzw));
  }
  // A thing before the toy is a part of the clean plate, and so is the rim of a thing beside it.
  let part = toy_layer(in_box, n_draws).a;
  let is_rim = is_at_end && part == 0.0;
  if is_rim || is_before_toy(evident) {
    return mat4x4f(whole, vec4f(1.0), vec4f(0.0), masks);
  }
  let has_moved = evident.b == 0.0 && has_moved_beside(in_box);
  find_beyond(texel, part, evident, has_moved, n_draws);
  var change = vec4f(0.0);
  let clean = receiver(position, f, evident, has_moved, 0.0, &change);
  let shaded = receiver(position, f, evident, has_moved, drawing.strength, &change);
  let ratio = select(vec3f(1.0), shaded / max(clean, vec3f(DARKEST_RATIO)), clean >= vec3f(DARKEST_RATIO));
  let over = whole.rgb - (1.0 - part) * clean * ratio;
  let toy = select(vec4f(0.0), vec4f(max(over, vec3f(0.0)), part), part > 0.0);
  let shadow = select(0.0, most_hidden(position.xy), is_receiver);
  return mat4x4f(vec4f(clean, 1.0), vec4f(ratio, 1.0), toy, vec4f(part, shadow, masks.ba));
}
