// The baseline's picture: plate in the masks of toy and shadow with a linear seam, the new shadows
// over it, the toy by projective texturing.
//
// Algorithm 1 blends by PCSS between the receiver without and with a light's shadow, light after
// light. That is a weighted mean over all sets of lights: a set's weight is the product of 1 - V
// over its lights and V over the others, its colour that of the real shadow of just these lights
// (section 4.6).
//
// Reads: frame, plate, masks (3a), eligible (3b), visibility of each light, terms of each set.
// Writes: linear colour, opaque.
// CPU reference: tests/reference/src/retarget.rs, for the receiver. Source: Casas et al. 2018,
// Algorithm 1 and sections 3.4, 4.3, 4.4 and 4.6.

//#import common/baseline
//#import common/fullscreen

@group(1) @binding(0) var frame: texture_2d<f32>;
@group(1) @binding(1) var plate: texture_2d<f32>;
@group(1) @binding(2) var masks: texture_2d<f32>;
@group(1) @binding(3) var visibility: texture_2d<f32>;
@group(1) @binding(4) var terms: texture_2d_array<f32>;
@group(1) @binding(5) var linear_sampler: sampler;
@group(1) @binding(6) var eligible: texture_2d<u32>;

// Blend weight of the plate: 1 in the masks, falling linearly to 0 over the seam.
fn cropped(texel: vec2i) -> f32 {
  let last = vec2i(textureDimensions(masks)) - 1;
  let seam = baseline.seam_px;
  var nearest = f32(seam) + 1.0;
  for (var y = -seam; y <= seam; y++) {
    for (var x = -seam; x <= seam; x++) {
      let other = clamp(texel + vec2i(x, y), vec2i(0), last);
      if textureLoad(masks, other, 0).r > 0.0 || textureLoad(eligible, other, 0).g != 0u {
        nearest = min(nearest, length(vec2f(f32(x), f32(y))));
      }
    }
  }
  return saturate(1.0 - nearest / (f32(seam) + 1.0));
}

// Sums of the terms of the set itself or, if it has none in the box, of the most similar set that
// has some.
fn sums_near(texel: vec2i, lights: u32) -> vec4f {
  let own = textureLoad(terms, texel, lights - 1u, 0);
  if own.a > 0.0 { return own; }
  var least = 0xffffffffu;
  var sums = vec4f(0.0);
  for (var other = 1u; other < 1u << globals.n_lights; other++) {
    let others = textureLoad(terms, texel, other - 1u, 0);
    let far = unlikeness(lights, other);
    if others.a > 0.0 && far < least {
      least = far;
      sums = others;
    }
  }
  return sums;
}

// Colour of the receiver if the lights of a set are hidden and all others visible.
fn shaded(texel: vec2i, lights: u32, lit: vec3f, b: vec3f) -> vec3f {
  let is_textured = ((baseline.textured_receivers >> receiver_at(texel)) & 1u) != 0u;
  if baseline.is_constant == 1u { return pow(baseline.constant_ratio, f32(countOneBits(lights))) * b; }
  let sums = sums_near(texel, lights);
  // Without a sample in reach the receiver stays lit and does not turn black.
  if sums.a == 0.0 { return lit; }
  let term = sums.rgb / sums.a;
  return select(term, term * b, is_textured);
}

// Weight of a set: product of 1 - V over its lights and V over the others.
fn weight(v: vec4f, lights: u32) -> f32 {
  var product = 1.0;
  for (var light = 0u; light < globals.n_lights; light++) {
    product *= select(v[light], 1.0 - v[light], ((lights >> light) & 1u) != 0u);
  }
  return product;
}

@fragment
fn fs_receiver(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy);
  let image_texel = texel + vec2i(globals.region_origin_px);
  let f = textureLoad(frame, image_texel, 0).rgb;
  let plate_texel = textureLoad(plate, texel, 0);
  let b = plate_texel.rgb;
  // Without a plate the frame passes through.
  if plate_texel.a == 0.0 { return vec4f(f, 1.0); }
  let lit = mix(f, b, cropped(texel));
  let v = textureLoad(visibility, texel, 0);
  var color = weight(v, 0u) * lit;
  for (var lights = 1u; lights < 1u << globals.n_lights; lights++) {
    let w = weight(v, lights);
    if w > 0.0 { color += w * shaded(texel, lights, lit, b); }
  }
  return vec4f(color, 1.0);
}

struct Surface {
  @builtin(position) clip: vec4f,
  @location(0) physical_clip: vec4f,
}

@vertex
fn vs_toy(@location(0) in_anchor: vec3f, @location(1) physical_in_anchor: vec3f) -> Surface {
  return Surface(globals.clip_from_anchor * vec4f(in_anchor, 1.0),
    globals.clip_from_anchor * vec4f(physical_in_anchor, 1.0));
}

@fragment
fn fs_toy(@location(0) physical_clip: vec4f) -> @location(0) vec4f {
  let region_px = (physical_clip.xy / physical_clip.w * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
  let uv = (region_px + globals.region_origin_px) / vec2f(textureDimensions(frame));
  return vec4f(textureSampleLevel(frame, linear_sampler, uv, 0.0).rgb, 1.0);
}
