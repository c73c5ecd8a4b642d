// Planes of luma and chroma (Cb, Cr) of half its size, rounded up, as sRGB codes. A chroma sample
// lies between its four luma samples; the importing shader declares them as `chroma`.
//
// Source: ITU-R BT.601-7, 2.5; BT.709-6, 3.

struct Encoding {
  srgb_from_ycbcr: mat3x3f,
  // Luma of black, and chroma of grey.
  origin: vec3f,
  _pad: u32,
}

// Chroma at a pixel: three quarters of its own sample, and one quarter of the sample on its other
// side. A sampler of 8 bits would be off by two codes.
fn chroma_at(texel: vec2i) -> vec2f {
  let last = vec2i(textureDimensions(chroma)) - 1;
  let own = texel / 2;
  let other = clamp(own + 2 * (texel % 2) - 1, vec2i(0), last);
  let above = 0.75 * textureLoad(chroma, own, 0).rg + 0.25 * textureLoad(chroma, vec2i(other.x, own.y), 0).rg;
  let below = 0.75 * textureLoad(chroma, vec2i(own.x, other.y), 0).rg + 0.25 * textureLoad(chroma, other, 0).rg;
  return 0.75 * above + 0.25 * below;
}

// sRGB codes of luma, Cb and Cr. No struct is passed: drivers of older Adreno keep those at 16
// bits.
fn codes_of(ycbcr: vec3f, srgb_from_ycbcr: mat3x3f, origin: vec3f) -> vec3f {
  return saturate(srgb_from_ycbcr * (ycbcr - origin));
}
