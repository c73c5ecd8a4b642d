// The camera's planes of luma and chroma, or a part of them, as sRGB codes. A chroma sample lies amid its four luma samples.
//
// Reads: luma, chroma (Cb, Cr) of half its size, rounded up. Writes: codes of that part of the camera image, opaque.
// CPU reference: reference/camera_planes.rs. Source: ITU-R BT.601-7, 2.5; BT.709-6, 3.

struct Encoding {
  srgb_from_ycbcr: mat3x3f,
  // Luma of black, and chroma of grey.
  origin: vec4f,
  // Top left corner of the part.
  corner_px: vec2i,
  unused: vec2i,
}

@group(1) @binding(0) var<uniform> encoding: Encoding;
@group(1) @binding(1) var luma: texture_2d<f32>;
@group(1) @binding(2) var chroma: texture_2d<f32>;

// Chroma at a pixel: three quarters of the sample that it is of, one of that on its other side. A sampler of 8 bits would
// be off by two codes.
fn chroma_at(texel: vec2i) -> vec2f {
  let last = vec2i(textureDimensions(chroma)) - 1;
  let own = texel / 2;
  let other = clamp(own + 2 * (texel % 2) - 1, vec2i(0), last);
  let above = 0.75 * textureLoad(chroma, own, 0).rg + 0.25 * textureLoad(chroma, vec2i(other.x, own.y), 0).rg;
  let below = 0.75 * textureLoad(chroma, vec2i(own.x, other.y), 0).rg + 0.25 * textureLoad(chroma, other, 0).rg;
  return 0.75 * above + 0.25 * below;
}

@fragment
fn fs_decode(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = encoding.corner_px + vec2i(at.xy);
  let ycbcr = vec3f(textureLoad(luma, texel, 0).r, chroma_at(texel));
  return vec4f(saturate(encoding.srgb_from_ycbcr * (ycbcr - encoding.origin.xyz)), 1.0);
}
