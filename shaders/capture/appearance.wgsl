// The toy's own colours from the camera frame, carried a little past its outline.
//
// Where a pixel mixes two surfaces its colour is taken from the nearest pixels that show one, preferring those at its
// own
// depth, so that a moved limb carries no rim of what was behind it.
//
// Each colour goes with the light it was seen under, so that it can be shown under another.
//
// Reads: frame, validity, gbuffer. Writes: linear colour, alpha 1 where a colour was found;
// radiance over base colour that the fit gives to the pixels it is from; their base colour.
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
  return textureLoad(frame, texel + vec2i(globals.region_origin_px), 0).rgb;
}

fn base_at(texel: vec2i) -> vec3f {
  return textureLoad(gbuffer_base, texel, 0).rgb;
}

fn lit_at(texel: vec2i) -> vec3f {
  return toy_radiance_over_base(textureLoad(gbuffer_normal, texel, 0).xyz, textureLoad(gbuffer_received, texel, 0));
}

struct Appearance {
  @location(0) color: vec4f,
  @location(1) lit: vec4f,
  @location(2) base: vec4f,
}

@fragment
fn fs_clean(@builtin(position) at: vec4f) -> Appearance {
  let texel = vec2i(at.xy);
  if textureLoad(validity, texel, 0).g == 1.0 {
    return Appearance(vec4f(frame_at(texel), 1.0), vec4f(lit_at(texel), 1.0), vec4f(base_at(texel), 1.0));
  }
  let last = vec2i(globals.region_size_px) - 1;
  let here = textureLoad(gbuffer_depth, texel, 0);
  var color = vec4f(0.0);
  var lit = vec3f(0.0);
  var base = vec3f(0.0);
  for (var y = -REACH_PX; y <= REACH_PX; y++) {
    for (var x = -REACH_PX; x <= REACH_PX; x++) {
      let other = clamp(texel + vec2i(x, y), vec2i(0), last);
      if textureLoad(validity, other, 0).g == 0.0 { continue; }
      let distance_squared = max(f32(x * x + y * y), 1.0);
      let is_own = here == 0.0 || is_same_surface(here, textureLoad(gbuffer_depth, other, 0));
      let weight = select(OTHER_SURFACE, 1.0, is_own) / (distance_squared * distance_squared);
      color += weight * vec4f(frame_at(other), 1.0);
      lit += weight * lit_at(other);
      base += weight * base_at(other);
    }
  }
  if color.a > 0.0 { return Appearance(color / color.a, vec4f(lit / color.a, 1.0), vec4f(base / color.a, 1.0)); }
  // A part too thin to have such a pixel: its own is the best there is.
  if here > 0.0 {
    return Appearance(vec4f(frame_at(texel), 1.0), vec4f(lit_at(texel), 1.0), vec4f(base_at(texel), 1.0));
  }
  return Appearance(vec4f(0.0), vec4f(0.0), vec4f(0.0));
}
