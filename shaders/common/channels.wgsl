// The largest and the smallest channel of a colour.

fn largest(c: vec3f) -> f32 {
  return max(c.r, max(c.g, c.b));
}

fn smallest(c: vec3f) -> f32 {
  return min(c.r, min(c.g, c.b));
}
