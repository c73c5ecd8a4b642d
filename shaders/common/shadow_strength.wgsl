// A shown shadow that is stronger or weaker than the true one.

// Remainder of the light `open` under a styled shadow, if the true one leaves `left`. A weaker one
// has a share of the loss; a stronger one is applied repeatedly, so that it keeps its hue.
fn strengthened(open: vec3f, left: vec3f, strength: f32) -> vec3f {
  if strength <= 1.0 { return mix(open, left, strength); }
  let part = select(vec3f(1.0), left / open, open > vec3f(0.0));
  // Light that the toy reflects onto the table is not a shadow.
  return open * pow(clamp(part, vec3f(0.0), vec3f(1.0)), vec3f(strength)) * max(part, vec3f(1.0));
}
