// The camera image with the work region laid over it, on a screen, turned and cropped; black beside it.
//
// Reads: frame and region, decoded. Writes: sRGB codes, opaque.
// Each is filtered by itself: at the region's border both show the same light.

struct ScreenMap {
  // Columns of the map from pixels of the screen to those of the picture.
  x_axis: vec2f,
  y_axis: vec2f,
  origin_px: vec2f,
  picture_px: vec2f,
  // Of the region, counted from the picture's corner.
  region_origin_px: vec2f,
  region_px: vec2f,
  // Part of the region's picture, the rest being the camera image: from 0 to 1.
  effect: f32,
  unused: f32,
}

@group(1) @binding(0) var<uniform> image_from_screen: ScreenMap;
@group(1) @binding(1) var frame: texture_2d<f32>;
@group(1) @binding(2) var region: texture_2d<f32>;
@group(1) @binding(3) var linear_sampler: sampler;

@fragment
fn fs_show(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = image_from_screen.x_axis * screen.x + image_from_screen.y_axis * screen.y + image_from_screen.origin_px;
  if any(at < vec2f(0.0)) || any(at > image_from_screen.picture_px) { return vec4f(0.0, 0.0, 0.0, 1.0); }
  let in_region = at - image_from_screen.region_origin_px;
  let is_in_region = all(in_region >= vec2f(0.0)) && all(in_region < image_from_screen.region_px);
  let effect = select(0.0, image_from_screen.effect, is_in_region);
  var light = vec3f(0.0);
  if effect < 1.0 {
    light = textureSampleLevel(frame, linear_sampler, at / image_from_screen.picture_px, 0.0).rgb;
  }
  if effect > 0.0 {
    let made = textureSampleLevel(region, linear_sampler, in_region / image_from_screen.region_px, 0.0).rgb;
    light = mix(light, made, effect);
  }
  return vec4f(srgb_from_linear(light), 1.0);
}
