// The published picture: plate in the masks of toy and shadow with a linear seam, the new shadow over it, the toy by
// projective texturing.
//
// Reads: frame, plate, masks 3a and 3b, visibility, shadow terms. Writes: linear colour, opaque.
// Source: Casas et al. 2018, sections 3.4, 4.3 and 4.4.

@group(1) @binding(0) var frame: texture_2d<f32>;
@group(1) @binding(1) var plate: texture_2d<f32>;
@group(1) @binding(2) var masks: texture_2d<f32>;
@group(1) @binding(3) var visibility: texture_2d<f32>;
@group(1) @binding(4) var terms: texture_2d<f32>;
@group(1) @binding(5) var linear_sampler: sampler;
@group(1) @binding(6) var eligible: texture_2d<f32>;

// How much of a pixel is cropped: 1 in the masks, falling linearly to 0 over the seam.
fn cropped(texel: vec2i) -> f32 {
  let last = vec2i(textureDimensions(masks)) - 1;
  let seam = published.seam_px;
  var nearest = f32(seam) + 1.0;
  for (var y = -seam; y <= seam; y++) {
    for (var x = -seam; x <= seam; x++) {
      let other = clamp(texel + vec2i(x, y), vec2i(0), last);
      if textureLoad(masks, other, 0).r + textureLoad(eligible, other, 0).g > 0.0 { nearest = min(nearest, length(vec2f(f32(x), f32(y)))); }
    }
  }
  return saturate(1.0 - nearest / (f32(seam) + 1.0));
}

fn shaded(texel: vec2i, lit: vec3f, b: vec3f) -> vec3f {
  if published.is_constant == 1u { return published.constant_ratio * b; }
  let sum = textureLoad(terms, texel, 0);
  // No sample in reach: the receiver stays lit rather than turning black.
  if sum.a == 0.0 { return lit; }
  let term = sum.rgb / sum.a;
  return select(term, term * b, published.is_textured == 1u);
}

@fragment
fn fs_receiver(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy);
  let image_texel = texel + vec2i(globals.region_origin_px);
  let f = textureLoad(frame, image_texel, 0).rgb;
  let lit_texel = textureLoad(plate, texel, 0);
  let b = lit_texel.rgb;
  // What no plate shows stays as it is.
  let lit = mix(f, b, cropped(texel) * lit_texel.a);
  let v = textureLoad(visibility, texel, 0).r;
  return vec4f(mix(shaded(texel, lit, b), lit, v), 1.0);
}

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) physical_clip: vec4f,
}

@vertex
fn vs_toy(@location(0) in_plane: vec3f, @location(1) physical_in_plane: vec3f) -> Surface {
  return Surface(globals.clip_from_stage * vec4f(in_plane, 1.0), globals.clip_from_stage * vec4f(physical_in_plane, 1.0));
}

@fragment
fn fs_toy(in: Surface) -> @location(0) vec4f {
  let region_px = (in.physical_clip.xy / in.physical_clip.w * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
  let uv = (region_px + globals.region_origin_px) / vec2f(textureDimensions(frame));
  return vec4f(textureSampleLevel(frame, linear_sampler, uv, 0.0).rgb, 1.0);
}
