// Noise of a camera, different for each picture, and the same for the same numbers.
//
// Source: Jarzynski and Olano 2020 (pcg4d).

// Variance of linear light, from `noise`: its variance in the dark, and its increase for each unit
// of light.
fn variance_of(noise: vec2f, light: vec3f) -> vec3f {
  return noise.x + noise.y * max(light, vec3f(0.0));
}

// Sum of the squares of the weights along a row: of a pixel, 1, and of those one and two pixels from
// it, on either side.
fn squared_weights(weights: vec2f) -> f32 {
  return 1.0 + 2.0 * dot(weights, weights);
}

// Correlations of pixels one and two apart along a row.
fn correlations_of(weights: vec2f) -> vec2f {
  let covariances = vec2f(2.0 * weights.x * (1.0 + weights.y), 2.0 * weights.y + weights.x * weights.x);
  return covariances / squared_weights(weights);
}

// Variance that remains of 1 after bilinear resampling, averaged over all positions between four
// pixels with correlated neighbours.
fn resampled_variance(weights: vec2f) -> f32 {
  let along = (2.0 + correlations_of(weights).x) / 3.0;
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

// Weight of a place along a row or column.
fn weight_at(place: i32, weights: vec2f) -> f32 {
  return select(1.0, select(weights.x, weights.y, abs(place) == 2), place != 0);
}

// Noise in three channels with this correlation between channels: white noise, averaged along rows
// and columns with weights of the pixels one and two away.
fn grain_at(at: vec2i, picture: u32, weights: vec2f, channels: f32) -> vec3f {
  // A pixel's own weight is 1, so that the loops always run: Mesa 22.3's software driver fails if a
  // uniform decides whether one does.
  let reach = select(select(0, 1, weights.x > 0.0), 2, weights.y > 0.0);
  var sum = vec4f(0.0);
  for (var y = -reach; y <= reach; y++) {
    for (var x = -reach; x <= reach; x++) {
      let weight = weight_at(x, weights) * weight_at(y, weights);
      sum += weight * white_noise(at + vec2i(x, y), picture);
    }
  }
  let noise = sum / squared_weights(weights);
  return sqrt(1.0 - channels) * noise.xyz + sqrt(channels) * noise.w;
}
