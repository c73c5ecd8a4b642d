// The camera's picture in the work region, as linear light, read in the form that it came in.

//#import common/globals
//#import common/srgb
//#import common/planes

// Whether it is planes: a constant, so that nothing of the other form is left in what is compiled.
override IS_PLANAR: bool = false;

@group(0) @binding(2) var<uniform> encoding: Encoding;
// A picture, or luma.
@group(0) @binding(3) var frame: texture_2d<f32>;
// Of planes alone.
@group(0) @binding(4) var chroma: texture_2d<f32>;

// Light at a texel of the region.
fn frame_at(texel: vec2i) -> vec3f {
  let in_picture = texel + vec2i(globals.region_origin_px);
  let stored = textureLoad(frame, in_picture, 0);
  if !IS_PLANAR { return stored.rgb; }
  let ycbcr = vec3f(stored.r, chroma_at(in_picture));
  return linear_from_srgb(codes_of(ycbcr, encoding.srgb_from_ycbcr, encoding.origin));
}
