// Visibility of a light from the hidden light points.
//
// Reads: occlusion targets. Writes: visibility in [0, 1].
// Twin: reference/visibility.rs.

@group(1) @binding(0) var hidden_0: texture_2d<f32>;
@group(1) @binding(1) var hidden_16: texture_2d<f32>;
@group(1) @binding(2) var hidden_32: texture_2d<f32>;
@group(1) @binding(3) var hidden_48: texture_2d<f32>;

// Number of light points drawn; each target holds 16 of them.
override N_POINTS: u32 = 64u;

@fragment
fn fs_average(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2u(at.xy);
  var hidden = textureLoad(hidden_0, texel, 0);
  if N_POINTS > 16u { hidden += textureLoad(hidden_16, texel, 0); }
  if N_POINTS > 32u { hidden += textureLoad(hidden_32, texel, 0); }
  if N_POINTS > 48u { hidden += textureLoad(hidden_48, texel, 0); }
  // A channel holds the mean of its four points.
  return vec4f(1.0 - dot(hidden, vec4f(4.0)) / f32(N_POINTS));
}
