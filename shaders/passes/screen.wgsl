// The camera image with the work region over it, on a screen, turned and cropped; black beside it.
//
// Reads: beside the region the frame, decoded or as luma and chroma (Cb, Cr) of half its size; in
// it the region's picture, and the frame as well where the region fades. Writes: sRGB codes,
// opaque.
// Frame and region are filtered separately, planes as codes: at the region's border they show the
// same light.

//#import common/srgb
//#import common/fullscreen
//#import common/planes

struct ScreenMap {
  // Columns of the map from pixels of the screen to pixels of the picture.
  x_axis: vec2f,
  y_axis: vec2f,
  origin_px: vec2f,
  picture_px: vec2f,
  // Corner of the region, counted from the picture's corner.
  region_origin_px: vec2f,
  region_px: vec2f,
  // Part of the region's picture, from 0 to 1; the rest is the camera image.
  effect: f32,
  unused: f32,
  // For planes alone: size of the chroma, and the conversion of their codes.
  chroma_px: vec2f,
  encoding: Encoding,
}

@group(1) @binding(0) var<uniform> image_from_screen: ScreenMap;
@group(1) @binding(1) var linear_sampler: sampler;
// A picture, or its luma.
@group(2) @binding(0) var frame: texture_2d<f32>;
@group(2) @binding(1) var chroma: texture_2d<f32>;
@group(3) @binding(0) var region: texture_2d<f32>;

const BLACK = vec3f(0.0);

// Pixel of the picture that a pixel of the screen shows.
fn shown_at(screen: vec4f) -> vec2f {
  return image_from_screen.x_axis * screen.x + image_from_screen.y_axis * screen.y + image_from_screen.origin_px;
}

fn is_in_picture(at: vec2f) -> bool {
  return all(at >= vec2f(0.0)) && all(at <= image_from_screen.picture_px);
}

// Linear light of the region's picture.
fn region_at(at: vec2f) -> vec3f {
  let in_region = at - image_from_screen.region_origin_px;
  return textureSampleLevel(region, linear_sampler, in_region / image_from_screen.region_px, 0.0).rgb;
}

// Linear light of a frame that is a picture.
fn picture_at(at: vec2f) -> vec3f {
  return textureSampleLevel(frame, linear_sampler, at / image_from_screen.picture_px, 0.0).rgb;
}

// Codes of the frame's planes.
fn decoded_at(at: vec2f) -> vec3f {
  let y = textureSampleLevel(frame, linear_sampler, at / image_from_screen.picture_px, 0.0).r;
  let cb_cr = textureSampleLevel(chroma, linear_sampler, 0.5 * at / image_from_screen.chroma_px, 0.0).rg;
  let encoding = &image_from_screen.encoding;
  return codes_of(vec3f(y, cb_cr), encoding.srgb_from_ycbcr, encoding.origin);
}

@fragment
fn fs_picture(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = shown_at(screen);
  return vec4f(select(BLACK, srgb_from_linear(picture_at(at)), is_in_picture(at)), 1.0);
}

@fragment
fn fs_planes(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = shown_at(screen);
  return vec4f(select(BLACK, decoded_at(at), is_in_picture(at)), 1.0);
}

@fragment
fn fs_region(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  return vec4f(srgb_from_linear(region_at(shown_at(screen))), 1.0);
}

@fragment
fn fs_region_over_picture(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = shown_at(screen);
  return vec4f(srgb_from_linear(mix(picture_at(at), region_at(at), image_from_screen.effect)), 1.0);
}

@fragment
fn fs_region_over_planes(@builtin(position) screen: vec4f) -> @location(0) vec4f {
  let at = shown_at(screen);
  let light = mix(linear_from_srgb(decoded_at(at)), region_at(at), image_from_screen.effect);
  return vec4f(srgb_from_linear(light), 1.0);
}
