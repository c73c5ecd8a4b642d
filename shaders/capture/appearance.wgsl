// The toy's own colours from the camera frame, carried a little past its outline.
//
// Where a pixel mixes two surfaces its colour is taken from the nearest pixels that show one, preferring those at its
// own
// depth, so that a moved limb carries no rim of what was behind it.
//
// Each colour goes with what light it was seen under, so that it can be shown under another. That and the base colour are
// the same for all pictures of a view: of a new picture `fs_recolor` takes the colours alone.
//
// Reads: frame, validity, gbuffer. Writes: in the toy box, linear colour, alpha 1 where a colour was found; each light's
// cosine times its visibility at the pixels it is from; their base colour, alpha how far they face upwards.
// CPU reference: reference/appearance.rs.

@group(1) @binding(0) var frame: texture_2d<f32>;
@group(1) @binding(1) var validity: texture_2d<f32>;
@group(1) @binding(2) var gbuffer_depth: texture_depth_2d;
@group(1) @binding(3) var gbuffer_normal: texture_2d<f32>;
@group(1) @binding(4) var gbuffer_received: texture_2d<f32>;
@group(1) @binding(5) var gbuffer_base: texture_2d<f32>;

// Farthest that a pixel of one surface is looked for.
const REACH_PX: i32 = 3;
// Weight of a colour at another depth: counts where there is no other.
const OTHER_SURFACE: f32 = 1e-4;

fn frame_at(texel: vec2i) -> vec3f {
  return textureLoad(frame, region_texel(texel), 0).rgb;
}

fn received_at(texel: vec2i) -> vec4f {
  return textureLoad(gbuffer_received, texel, 0);
}

// Base colour, and the part of what the surface sees that lies above the horizon.
fn base_at(texel: vec2i) -> vec4f {
  let normal = textureLoad(gbuffer_normal, texel, 0).xyz;
  return vec4f(textureLoad(gbuffer_base, texel, 0).rgb, hemispheres(normal).x);
}

fn is_one_surface(texel: vec2i) -> bool {
  return textureLoad(validity, texel, 0).g == 1.0;
}

// How far from a pixel others are looked for; not at all where it shows one surface, or is well clear of the toy.
fn reach_from(texel: vec2i) -> i32 {
  let marks = textureLoad(validity, texel, 0);
  return select(REACH_PX, -1, marks.g == 1.0 || marks.b == 1.0);
}

// Weight of the pixel at an offset from one at `here`'s depth.
fn weight_of(offset: vec2i, other: vec2i, here: f32) -> f32 {
  if !is_one_surface(other) { return 0.0; }
  let distance_squared = max(f32(offset.x * offset.x + offset.y * offset.y), 1.0);
  let is_own = here == 0.0 || is_same_surface(here, textureLoad(gbuffer_depth, other, 0));
  return select(OTHER_SURFACE, 1.0, is_own) / (distance_squared * distance_squared);
}

struct Appearance {
  @location(0) color: vec4f,
  @location(1) received: vec4f,
  @location(2) base: vec4f,
}

@fragment
fn fs_clean(@builtin(position) at: vec4f) -> Appearance {
  let texel = vec2i(at.xy);
  if is_one_surface(texel) {
    return Appearance(vec4f(frame_at(texel), 1.0), received_at(texel), base_at(texel));
  }
  let here = textureLoad(gbuffer_depth, texel, 0);
  var color = vec4f(0.0);
  var received = vec4f(0.0);
  var base = vec4f(0.0);
  let reach_px = reach_from(texel);
  for (var y = -reach_px; y <= reach_px; y++) {
    for (var x = -reach_px; x <= reach_px; x++) {
      let other = clamped_to_box(texel + vec2i(x, y));
      let weight = weight_of(vec2i(x, y), other, here);
      if weight == 0.0 { continue; }
      color += weight * vec4f(frame_at(other), 1.0);
      received += weight * received_at(other);
      base += weight * base_at(other);
    }
  }
  if color.a > 0.0 { return Appearance(color / color.a, received / color.a, base / color.a); }
  // A part too thin to have such a pixel: its own is the best there is.
  if here > 0.0 { return Appearance(vec4f(frame_at(texel), 1.0), received_at(texel), base_at(texel)); }
  return Appearance(vec4f(0.0), vec4f(0.0), vec4f(0.0));
}

// As above, the colours alone.
@fragment
fn fs_recolor(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  if is_one_surface(texel) { return vec4f(frame_at(texel), 1.0); }
  let here = textureLoad(gbuffer_depth, texel, 0);
  var color = vec4f(0.0);
  let reach_px = reach_from(texel);
  for (var y = -reach_px; y <= reach_px; y++) {
    for (var x = -reach_px; x <= reach_px; x++) {
      let other = clamped_to_box(texel + vec2i(x, y));
      let weight = weight_of(vec2i(x, y), other, here);
      if weight > 0.0 { color += weight * vec4f(frame_at(other), 1.0); }
    }
  }
  if color.a > 0.0 { return color / color.a; }
  if here > 0.0 { return vec4f(frame_at(texel), 1.0); }
  return vec4f(0.0);
}
