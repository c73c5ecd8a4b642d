// The camera's planes of luma and chroma as sRGB codes.
//
// Reads: luma, chroma (Cb, Cr) of half its size, rounded up. Writes: codes of the camera image, opaque.
// CPU reference: tests/reference/src/camera_planes.rs.

//#import common/fullscreen
//#import common/planes

@group(1) @binding(0) var<uniform> encoding: Encoding;
@group(1) @binding(1) var luma: texture_2d<f32>;
@group(1) @binding(2) var chroma: texture_2d<f32>;

@fragment
fn fs_decode(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let ycbcr = vec3f(textureLoad(luma, texel, 0).r, chroma_at(texel));
  return vec4f(codes_of(ycbcr, encoding.srgb_from_ycbcr, encoding.origin), 1.0);
}
