// Accumulated values of a cell: sum of values times certainty, and of certainties.

// Cap of the accumulated weight, in frames.
const MAX_FRAMES: f32 = 8.0;

// Caps accumulated weight.
fn capped(sum: vec4f) -> vec4f {
  return sum * min(1.0, MAX_FRAMES / max(sum.a, MAX_FRAMES));
}

// The mean value times its certainty, and the certainty, at most 1.
fn mean_of(sum: vec4f) -> vec4f {
  return sum / max(sum.a, 1.0);
}
