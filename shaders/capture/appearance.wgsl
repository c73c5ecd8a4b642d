// The toy's own colours from the camera frame, carried a little past its outline.
//
// Where a pixel mixes two surfaces its colour is that of the nearest pixel that shows one, of those at its own depth
// before others, so that a moved limb carries no rim of what was behind it.
//
// Each colour goes with what light it was seen under, so that it can be shown under another. That, the base colour and
// the pixel that a colour is from are the same for all pictures of a view: of a new picture `fs_recolor` takes the
// colours alone.
//
// Reads: frame, validity, gbuffer; of a new picture frame and source. Writes: in the toy box, linear colour, alpha 1
// where a colour was found; each light's cosine times its visibility at the pixels it is from; their base colour, alpha
// how far they face upwards; the source, which pixels they are.
// CPU reference: reference/appearance.rs.

@group(1) @binding(0) var frame: texture_2d<f32>;
@group(1) @binding(1) var source: texture_2d<f32>;
@group(1) @binding(2) var validity: texture_2d<f32>;
@group(1) @binding(3) var gbuffer_depth: texture_depth_2d;
@group(1) @binding(4) var gbuffer_normal: texture_2d<f32>;
@group(1) @binding(5) var gbuffer_received: texture_2d<f32>;
@group(1) @binding(6) var gbuffer_base: texture_2d<f32>;

// Farthest that a pixel of one surface is looked for, and the side of the square within.
const REACH_PX: i32 = 3;
const SIDE_PX: i32 = 2 * REACH_PX + 1;
// Added to the squared distance of a pixel at another depth: it counts where there is no other.
const OTHER_SURFACE: i32 = 64;
// Of a pixel that no colour is found for. Others are numbered row by row of the square around it.
const NO_SOURCE: u32 = 255u;

fn number_of(offset: vec2i) -> u32 {
  return u32((offset.y + REACH_PX) * SIDE_PX + offset.x + REACH_PX);
}

fn source_of(number: u32) -> vec4f {
  return vec4f(f32(number) / 255.0, 0.0, 0.0, 0.0);
}

// Texel of the source with a number.
fn source_texel(texel: vec2i, number: u32) -> vec2i {
  let place = vec2i(i32(number) % SIDE_PX, i32(number) / SIDE_PX);
  return clamped_to_box(texel + place - REACH_PX);
}

fn frame_at(texel: vec2i) -> vec3f {
  return textureLoad(frame, region_texel(texel), 0).rgb;
}

// Base colour, and the part of what the surface sees that lies above the horizon.
fn base_at(texel: vec2i) -> vec4f {
  let normal = textureLoad(gbuffer_normal, texel, 0).xyz;
  return vec4f(textureLoad(gbuffer_base, texel, 0).rgb, hemispheres(normal).x);
}

fn is_one_surface(texel: vec2i) -> bool {
  return textureLoad(validity, texel, 0).g == 1.0;
}

// Number of the pixel that a pixel's colour is from.
fn nearest_source(texel: vec2i) -> u32 {
  let marks = textureLoad(validity, texel, 0);
  if marks.g == 1.0 { return number_of(vec2i(0)); }
  // Well clear of the toy.
  if marks.b == 1.0 { return NO_SOURCE; }
  let here = textureLoad(gbuffer_depth, texel, 0);
  // A part too thin to have such a pixel: its own is the best there is.
  var nearest = select(NO_SOURCE, number_of(vec2i(0)), here > 0.0);
  var least = 2 * OTHER_SURFACE;
  for (var y = -REACH_PX; y <= REACH_PX; y++) {
    for (var x = -REACH_PX; x <= REACH_PX; x++) {
      let other = clamped_to_box(texel + vec2i(x, y));
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
  @location(0) color: vec4f,
  @location(1) received: vec4f,
  @location(2) base: vec4f,
  // Number in r, in codes.
  @location(3) source: vec4f,
}

@fragment
fn fs_clean(@builtin(position) at: vec4f) -> Appearance {
  let texel = vec2i(at.xy);
  let number = nearest_source(texel);
  if number == NO_SOURCE { return Appearance(vec4f(0.0), vec4f(0.0), vec4f(0.0), source_of(number)); }
  let from_texel = source_texel(texel, number);
  let received = textureLoad(gbuffer_received, from_texel, 0);
  return Appearance(vec4f(frame_at(from_texel), 1.0), received, base_at(from_texel), source_of(number));
}

// As above, the colours alone.
@fragment
fn fs_recolor(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let number = u32(round(255.0 * textureLoad(source, texel, 0).r));
  if number == NO_SOURCE { return vec4f(0.0); }
  return vec4f(frame_at(source_texel(texel, number)), 1.0);
}
