// The camera pixels from which the toy's own colours come, also a little beyond its outline.
//
// A pixel that mixes two surfaces gets the colour of the nearest pixel that shows a single one,
// preferably at its own depth, so that a moved limb has no rim of the background.
//
// Each colour is stored with the light on it, so that it can be shown in another light. This is the
// same for all pictures of a view, from which `toy` takes the colours.
//
// Reads: validity, gbuffer. Writes: in the physical box, the source, which is the pixel of the
// colour; each light's cosine times its visibility there; its base colour, with its upward part in
// alpha.
// CPU reference: tests/reference/src/appearance.rs.

//#import common/globals
//#import common/depth
//#import common/fullscreen
//#import common/source
//#import common/marks

@group(1) @binding(0) var validity: texture_2d<f32>;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d;
@group(1) @binding(2) var gbuffer_received: texture_2d<f32>;
@group(1) @binding(3) var gbuffer_base: texture_2d<f32>;

// Added to the squared distance of a pixel at another depth, which counts only if there is no
// other.
const OTHER_SURFACE: i32 = 64;

fn is_one_surface(texel: vec2i) -> bool {
  return textureLoad(validity, texel, 0).g > 0.0;
}

// Number of the pixel from which a pixel's colour comes.
fn nearest_source(texel: vec2i) -> u32 {
  let marks = textureLoad(validity, texel, 0);
  if marks.g > 0.0 { return number_of(vec2i(0)); }
  // The pixel is well clear of the toy.
  if marks.b == 1.0 { return NO_SOURCE; }
  let here = textureLoad(gbuffer_depth, texel, 0);
  // A part without such a pixel is too thin: its own pixel is the best, unless that shows a thing
  // before it.
  var nearest = select(NO_SOURCE, number_of(vec2i(0)), here > 0.0 && !is_before_toy(marks));
  var least = 2 * OTHER_SURFACE;
  for (var y = -REACH_PX; y <= REACH_PX; y++) {
    for (var x = -REACH_PX; x <= REACH_PX; x++) {
      let other = clamped_to_physical_box(texel + vec2i(x, y));
      let is_own = here == 0.0 || is_same_surface(here, textureLoad(gbuffer_depth, other, 0));
      let far = x * x + y * y + select(OTHER_SURFACE, 0, is_own);
      if far < least && is_one_surface(other) {
        least = far;
        nearest = number_of(vec2i(x, y));
      }
    }
  }
  return nearest;
}

struct Appearance {
  @location(0) received: vec4f,
  @location(1) base: vec4f,
  // The number is in r, in codes.
  @location(2) source: vec4f,
}

@fragment
fn fs_clean(@builtin(position) at: vec4f) -> Appearance {
  let texel = vec2i(at.xy);
  let number = nearest_source(texel);
  if number == NO_SOURCE { return Appearance(vec4f(0.0), vec4f(0.0), source_of(number)); }
  let from_texel = source_texel(texel, number);
  return Appearance(textureLoad(gbuffer_received, from_texel, 0), textureLoad(gbuffer_base, from_texel, 0), source_of(number));
}
