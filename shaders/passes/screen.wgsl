// The camera image with the work region laid over it, on a screen, turned and cropped; black beside it.
//
// Reads: region and, as a picture, frame, both decoded; or the frame's luma and chroma (Cb, Cr) of half its size. Writes: sRGB
// codes, opaque.
// Frame and region are each filtered by itself, planes as codes: at the region's border all show the same light.

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
  // Of planes alone: size of the chroma, the map to sRGB codes, luma of black and chroma of grey.
  chroma_px: vec2f,
  srgb_from_ycbcr: mat3x3f,
  grey: vec4f,
}

@group(1) @binding(0) var<uniform> image_from_screen: ScreenMap;
@group(1) @binding(1) var region: texture_2d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;
// A picture, or luma.
@group(1) @binding(3) var frame: texture_2d<f32>;
@group(1) @binding(4) var chroma: texture_2d<f32>;

const BLACK = vec4f(0.0, 0.0, 0.0, 1.0);

// Pixel of the picture that a pixel of the screen shows.
fn shown_at(screen: vec2f) -> vec2f {
  return image_from_screen.x_axis * screen.x + image_from_screen.y_axis * screen.y + image_from_screen.origin_px;
}

fn is_in_picture(at: vec2f) -> bool {
  return all(at >= vec2f(0.0)) && all(at <= image_from_screen.picture_px);
}

// How much of the region's picture is shown.
fn effect_at(at: vec2f) -> f32 {
  let in_region = at - image_from_screen.region_origin_px;
  let is_in_region = all(in_region >= vec2f(0.0)) && all(in_region < image_from_screen.region_px);
  return select(0.0, image_from_screen.effect, is_in_region);
}

fn region_at(at: vec2f) -> vec3f {
  let in_region = at - image_from_screen.region_origin_px;
  return textureSampleLevel(region, linear_sampler, in_region / image_from_screen.region_px, 0.0).rgb;
}

@fragment
fn fs_show(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = shown_at(screen.xy);
  if !is_in_picture(at) { return BLACK; }
  let effect = effect_at(at);
  var light = vec3f(0.0);
  if effect < 1.0 {
    light = textureSampleLevel(frame, linear_sampler, at / image_from_screen.picture_px, 0.0).rgb;
  }
  if effect > 0.0 { light = mix(light, region_at(at), effect); }
  return vec4f(srgb_from_linear(light), 1.0);
}

// Codes of the frame's planes. A chroma sample lies amid its four luma samples.
fn decoded_at(at: vec2f) -> vec3f {
  let y = textureSampleLevel(frame, linear_sampler, at / image_from_screen.picture_px, 0.0).r;
  let cb_cr = textureSampleLevel(chroma, linear_sampler, 0.5 * at / image_from_screen.chroma_px, 0.0).rg;
  return saturate(image_from_screen.srgb_from_ycbcr * (vec3f(y, cb_cr) - image_from_screen.grey.xyz));
}

@fragment
fn fs_show_planes(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = shown_at(screen.xy);
  if !is_in_picture(at) { return BLACK; }
  let effect = effect_at(at);
  if effect == 0.0 { return vec4f(decoded_at(at), 1.0); }
  var light = region_at(at);
  if effect < 1.0 { light = mix(linear_from_srgb(decoded_at(at)), light, effect); }
  return vec4f(srgb_from_linear(light), 1.0);
}
