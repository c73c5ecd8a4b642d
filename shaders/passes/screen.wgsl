// The finished picture on a screen, turned and cropped; black beside it.
//
// Reads: picture, decoded. Writes: sRGB codes, opaque.

struct ScreenMap {
  // Columns of the map from pixels of the screen to those of the picture.
  x_axis: vec2f,
  y_axis: vec2f,
  origin_px: vec2f,
  picture_px: vec2f,
}

@group(1) @binding(0) var<uniform> image_from_screen: ScreenMap;
@group(1) @binding(1) var picture: texture_2d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;

@fragment
fn fs_show(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = image_from_screen.x_axis * screen.x + image_from_screen.y_axis * screen.y + image_from_screen.origin_px;
  if any(at < vec2f(0.0)) || any(at > image_from_screen.picture_px) { return vec4f(0.0, 0.0, 0.0, 1.0); }
  let light = textureSampleLevel(picture, linear_sampler, at / image_from_screen.picture_px, 0.0).rgb;
  return vec4f(srgb_from_linear(light), 1.0);
}
