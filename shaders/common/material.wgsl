// Base colour of the toy's model, linear.

// Factor of each material; a draw's instance is its material.
@group(2) @binding(0) var<storage, read> base_colors_linear: array<vec4f>;
@group(2) @binding(1) var base_texture: texture_2d<f32>;
@group(2) @binding(2) var base_sampler: sampler;

// Bias for half a pixel's footprint, since base colour distinguishes camera pixels: RMSE of the
// bundled toy 3.18 codes, 3.53 at a bias of 0, 3.21 without mips.
const MIP_BIAS: f32 = -1.0;

fn base_color(material: u32, uv: vec2f, vertex_color: vec4f) -> vec3f {
  let texel = textureSampleBias(base_texture, base_sampler, uv, MIP_BIAS);
  return (base_colors_linear[material] * vertex_color * texel).rgb;
}

// Interpolated normals can vanish between opposite ones; up is as good as any other direction then.
fn unit_normal(v: vec3f) -> vec3f {
  let length_squared = dot(v, v);
  if length_squared == 0.0 { return vec3f(0.0, 1.0, 0.0); }
  return v * inverseSqrt(length_squared);
}
