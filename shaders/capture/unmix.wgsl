// Factor from each colour of the toy, which a soft picture mixes from its surfaces, to that of the one at
// the pixel's centre.
//
//   frame = spread of (tint x model), so model / (spread of model) x frame is the colour of one surface
// It depends on no pixel of the frame, but on its spread and on the lights' intensities in it.
//
// Reads: gbuffer, fit. Writes: in the physical box, the factor as codes of ten bits.
// CPU reference: tests/reference/src/unmix.rs.

//#import common/unmixed
//#import common/fullscreen

@group(1) @binding(0) var gbuffer_depth: texture_depth_2d;
@group(1) @binding(1) var gbuffer_received: texture_2d<f32>;
@group(1) @binding(2) var gbuffer_base: texture_2d<f32>;

@fragment
fn fs_unmix(@builtin(position) position: vec4f) -> @location(0) vec4f {
  return vec4f(coded_factor(unmixed_factor(vec2i(position.xy))), 1.0);
}
