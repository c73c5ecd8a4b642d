// The camera image with the work region over it, code for code, or blended by the effect.
//
// Reads: frame_codes and region_codes, 8 bits; or both as linear light. Writes: the same, opaque.

//#import common/srgb
//#import common/fullscreen

struct Placement {
  origin_px: vec2u,
  size_px: vec2u,
  // Part of the region's picture, from 0 to 1; the rest is the camera image.
  effect: f32,
  unused: f32,
}

@group(1) @binding(0) var<uniform> placement: Placement;
@group(1) @binding(1) var frame_codes: texture_2d<f32>;
@group(1) @binding(2) var region_codes: texture_2d<f32>;

@fragment
fn fs_place(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2u(at.xy);
  // Left of the region and above it, this wraps to a large number.
  let in_region = texel - placement.origin_px;
  if all(in_region < placement.size_px) {
    let region = textureLoad(region_codes, in_region, 0).rgb;
    if placement.effect == 1.0 { return vec4f(region, 1.0); }
    let frame = textureLoad(frame_codes, texel, 0).rgb;
    let light = mix(linear_from_srgb(frame), linear_from_srgb(region), placement.effect);
    return vec4f(srgb_from_linear(light), 1.0);
  }
  return vec4f(textureLoad(frame_codes, texel, 0).rgb, 1.0);
}

// The same for linear light.
@fragment
fn fs_light(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2u(at.xy);
  let frame = textureLoad(frame_codes, texel, 0).rgb;
  let in_region = texel - placement.origin_px;
  if any(in_region >= placement.size_px) { return vec4f(frame, 1.0); }
  return vec4f(mix(frame, textureLoad(region_codes, in_region, 0).rgb, placement.effect), 1.0);
}
