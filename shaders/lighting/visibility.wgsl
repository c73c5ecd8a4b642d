// Visibility of a light from the hidden light points.
//
// Reads: hidden, the target of `occlusion`. Writes: visibility in [0, 1].
// CPU reference: reference/visibility.rs.

// Number of light points drawn.
@group(1) @binding(0) var<uniform> n_points: u32;
@group(1) @binding(1) var hidden: texture_2d<f32>;

@fragment
fn fs_average(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let n_hidden = round(textureLoad(hidden, vec2u(at.xy), 0).r / HIDDEN_POINT);
  return vec4f(1.0 - n_hidden / f32(n_points));
}
