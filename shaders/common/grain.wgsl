// Noise of a camera, different for each picture, and the same for the same numbers.
//
// Source: Jarzynski and Olano 2020 (pcg4d).

// Variance of linear light, from `noise`: its variance in the dark, and its increase for each unit
// of light.
fn variance_of(noise: vec2f, light: vec3f) -> vec3f {
  return noise.x + noise.y * max(light, vec3f(0.0));
}

// Variance that remains of 1 after bilinear resampling, averaged over all positions between four
// pixels with correlated neighbours.
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

// Noise of mean 0 and variance 1 in each of four numbers: the sum of two uniform ones.
fn white_noise(at: vec2i, picture: u32) -> vec4f {
  let bits = hashed(vec4u(vec2u(at), picture, 0u));
  return (vec4f(bits & vec4u(0xffffu)) + vec4f(bits >> vec4u(16u)) - 65535.0) * (2.4494897 / 65536.0);
}

// Noise in three channels with this correlation between channels and between neighbouring pixels.
// The latter are means over three pixels each way, and the weight of the outer ones gives the
// correlation 2 w / (1 + 2 w w).
fn grain_at(at: vec2i, picture: u32, beside: f32, channels: f32) -> vec3f {
  // The loop also runs if it is 0: Mesa 22.3's software driver fails if a uniform decides whether a
  // loop runs.
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
