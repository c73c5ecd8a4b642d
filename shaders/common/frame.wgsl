// The camera's picture in the work region, as linear light, read in its original form.

//#import common/globals
//#import common/srgb
//#import common/planes

// Whether the picture has planes: a constant, so that the compiled shader contains one form only.
override IS_PLANAR: bool = false;

@group(0) @binding(2) var<uniform> encoding: Encoding;
// A picture, or its luma.
@group(0) @binding(3) var frame: texture_2d<f32>;
// The chroma of planes.
@group(0) @binding(4) var chroma: texture_2d<f32>;

// Linear light at a texel of the region.
fn frame_at(texel: vec2i) -> vec3f {
  let in_picture = texel + vec2i(globals.region_origin_px);
  let stored = textureLoad(frame, in_picture, 0);
  if !IS_PLANAR { return stored.rgb; }
  let ycbcr = vec3f(stored.r, chroma_at(in_picture));
  return linear_from_srgb(codes_of(ycbcr, encoding.srgb_from_ycbcr, encoding.origin));
}
