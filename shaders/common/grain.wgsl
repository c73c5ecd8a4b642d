// Noise of a camera, made anew for each picture: the same wherever its numbers are the same.
//
// Source: Jarzynski and Olano 2020 (pcg4d).

// Variance of linear light, by (variance in the dark, more for each unit of light).
fn variance_of(noise: vec2f, light: vec3f) -> vec3f {
  return noise.x + noise.y * max(light, vec3f(0.0));
}

// What is left of a variance of 1 after bilinear resampling, on average over all places between four pixels of which those
// side by side are correlated.
fn resampled_variance(beside: f32) -> f32 {
  let along = (2.0 + beside) / 3.0;
  return along * along;
}

fn hashed(seed: vec4u) -> vec4u {
  var v = seed * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> vec4u(16u);
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// Of mean 0 and variance 1 in each of four numbers: the sum of two that are even.
fn white_noise(at: vec2i, picture: u32) -> vec4f {
  let bits = hashed(vec4u(vec2u(at), picture, 0u));
  return (vec4f(bits & vec4u(0xffffu)) + vec4f(bits >> vec4u(16u)) - 65535.0) * (2.4494897 / 65536.0);
}

// The same in three channels, which share so much of it, as pixels side by side do. Those are means over three pixels each
// way, of which the outer ones have a weight that gives the correlation 2 w / (1 + 2 w w).
fn grain_at(at: vec2i, picture: u32, beside: f32, channels: f32) -> vec3f {
  // Also where it is 0: Mesa 22.3's software driver fails on a uniform that decides whether a loop runs.
  let weight = beside / (1.0 + sqrt(max(1.0 - 2.0 * beside * beside, 0.0)));
  var sum = vec4f(0.0);
  for (var y = -1; y <= 1; y++) {
    for (var x = -1; x <= 1; x++) {
      let far = select(1.0, weight, x != 0) * select(1.0, weight, y != 0);
      sum += far * white_noise(at + vec2i(x, y), picture);
    }
  }
  let noise = sum / (1.0 + 2.0 * weight * weight);
  return sqrt(1.0 - channels) * noise.xyz + sqrt(channels) * noise.w;
}
