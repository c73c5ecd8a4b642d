// Ambient light of two colours, from above and from below.

// Parts of a surface's view that lie above and below the horizon, weighted by the cosine; `normal` is in anchor space.
// Source: Liu and Jordan 1963 (view factors of a tilted surface under an even sky).
fn hemispheres(normal: vec3f) -> vec2f {
  return vec2f(0.5 + 0.5 * normal.y, 0.5 - 0.5 * normal.y);
}
