// What frames have told of a cell: sum of values times certainty, and of certainties.

// What was known before weighs at most as much as this many frames.
const MAX_FRAMES: f32 = 8.0;

// What of it the frames to come add to.
fn capped(sum: vec4f) -> vec4f {
  return sum * min(1.0, MAX_FRAMES / max(sum.a, MAX_FRAMES));
}

// The value times its certainty, and that, at most 1.
fn mean_of(sum: vec4f) -> vec4f {
  return sum / max(sum.a, 1.0);
}
