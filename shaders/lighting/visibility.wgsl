// Visibility of up to four lights from their hidden light points.
//
// Reads: hidden, the targets of `occlusion`, one a light. Writes: visibility in [0, 1], a channel a light.
// CPU reference: reference/visibility.rs.

// Number of light points drawn of each light; 0 for one that there is not.
@group(1) @binding(0) var<uniform> n_points: vec4u;
@group(1) @binding(1) var hidden_0: texture_2d<f32>;
@group(1) @binding(2) var hidden_1: texture_2d<f32>;
@group(1) @binding(3) var hidden_2: texture_2d<f32>;
@group(1) @binding(4) var hidden_3: texture_2d<f32>;

@fragment
fn fs_average(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2u(at.xy);
  let counted = vec4f(
    textureLoad(hidden_0, texel, 0).r,
    textureLoad(hidden_1, texel, 0).r,
    textureLoad(hidden_2, texel, 0).r,
    textureLoad(hidden_3, texel, 0).r,
  );
  let n_hidden = round(counted / HIDDEN_POINT);
  return select(vec4f(0.0), 1.0 - n_hidden / vec4f(max(n_points, vec4u(1u))), n_points > vec4u(0u));
}
