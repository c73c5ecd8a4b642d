// The paper's masks 3b and 3c: g is the real shadow with its penumbra, r the part of its umbra that the camera sees, a
// margin away from the object and from the penumbra.
//
// Reads: mask 3a, visibility with the physical toy. Writes: 0 or 1.
// Source: Casas et al. 2018, sections 3.3 and 4.2 (3b is the soft shadow made binary). The margin is ours: a pixel at an
// edge is half lit, or half toy.

@group(1) @binding(0) var masks: texture_2d<f32>;
@group(1) @binding(1) var visibility: texture_2d<f32>;

// Less shadow than this is not worth cropping: two codes of a white table.
const FAINT: f32 = 0.01;

fn is_umbra(texel: vec2i) -> bool {
  let at = clamp(texel, vec2i(0), vec2i(textureDimensions(masks)) - 1);
  return textureLoad(masks, at, 0).r == 0.0 && textureLoad(visibility, at, 0).r == 0.0;
}

@fragment
fn fs_mark(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let in_shadow = select(0.0, 1.0, textureLoad(visibility, texel, 0).r < 1.0 - FAINT);
  let margin = published.eligible_margin_px;
  for (var y = -margin; y <= margin; y++) {
    for (var x = -margin; x <= margin; x++) {
      if !is_umbra(texel + vec2i(x, y)) { return vec4f(0.0, in_shadow, 0.0, 1.0); }
    }
  }
  return vec4f(1.0, in_shadow, 0.0, 1.0);
}
