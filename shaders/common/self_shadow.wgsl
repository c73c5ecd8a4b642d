// Self-shadowing of the toy: visibility of a light at a point of its surface.
//
// Depth maps from points of each light are tiles of one atlas; a point is compared with each and
// the results averaged.
// Bias: the point is moved along its normal by the largest rise of the surface between two texels
// of a tile.
// Source: Williams 1978 (shadow maps), Holbert 2011 (normal offset; here in closed form), Heckbert
// and Herf 1997 (soft shadows as a mean over light points).

//#import common/toy_light

const MAX_TILES: u32 = 64u;

struct SelfShadow {
  // Clip space of the atlas, one tile each; depth is reversed, 0 for nothing.
  atlas_from_anchor: array<mat4x4f, MAX_TILES>,
  // Per light: index of its first tile, its number of tiles, 0 for one without shadow on the toy,
  // and the width of a texel in metres at w = 1.
  first_tile: vec4u,
  n_tiles: vec4u,
  texel_m: vec4f,
}

@group(3) @binding(0) var<uniform> self_shadow: SelfShadow;
@group(3) @binding(1) var self_depth: texture_depth_2d;
@group(3) @binding(2) var nearer: sampler_comparison;
// Maps of the physical pose, for shaders that need both; otherwise the same as above.
@group(3) @binding(3) var<uniform> physical_self_shadow: SelfShadow;
@group(3) @binding(4) var physical_self_depth: texture_depth_2d;

// A filtered comparison reaches one texel to each side.
const FILTER_REACH_TEXELS: f32 = 1.41421356;

fn clip_in_tile(is_physical: bool, tile: u32, in_anchor: vec3f) -> vec4f {
  if is_physical { return physical_self_shadow.atlas_from_anchor[tile] * vec4f(in_anchor, 1.0); }
  return self_shadow.atlas_from_anchor[tile] * vec4f(in_anchor, 1.0);
}

fn passing_part(is_physical: bool, clip: vec4f) -> f32 {
  let at = clip.xyz / clip.w;
  let in_atlas = at.xy * vec2f(0.5, -0.5) + 0.5;
  if is_physical { return textureSampleCompareLevel(physical_self_depth, nearer, in_atlas, at.z); }
  return textureSampleCompareLevel(self_depth, nearer, in_atlas, at.z);
}

// Visibility in [0, 1]; `cosine` is that of `normal` to the light.
fn self_visibility(is_physical: bool, i: u32, in_anchor: vec3f, normal: vec3f, cosine: f32) -> f32 {
  let n_tiles = select(self_shadow.n_tiles, physical_self_shadow.n_tiles, is_physical)[i];
  if n_tiles == 0u { return 1.0; }
  let first = select(self_shadow.first_tile, physical_self_shadow.first_tile, is_physical)[i];
  let texel_m = select(self_shadow.texel_m, physical_self_shadow.texel_m, is_physical)[i];
  let w = clip_in_tile(is_physical, first, in_anchor).w;
  // Over the texel's reach a plane rises by reach sin / cos towards the light, and this raises the
  // point by offset / cos.
  let sine = sqrt(saturate(1.0 - cosine * cosine));
  let lifted = in_anchor + FILTER_REACH_TEXELS * texel_m * w * sine * normal;
  var sum = 0.0;
  for (var tile = first; tile < first + n_tiles; tile++) {
    sum += passing_part(is_physical, clip_in_tile(is_physical, tile, lifted));
  }
  return sum / f32(n_tiles);
}

// Each light's cosine times its visibility, in the pose of the group's first maps or in the physical one.
fn light_received(is_physical: bool, normal: vec3f, in_anchor: vec3f) -> vec4f {
  var received = vec4f(0.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    let cosine = light_cosine(i, normal, in_anchor);
    if cosine > 0.0 { received[i] = cosine * self_visibility(is_physical, i, in_anchor, normal, cosine); }
  }
  return received;
}
