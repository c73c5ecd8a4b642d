// What frames have told of a cell: sum of values times certainty, and of certainties.

// What was known before weighs at most as much as this many frames.
const MOST_KEPT: f32 = 8.0;

// What of it the frames to come add to.
fn to_keep(known: vec4f) -> vec4f {
  return known * min(1.0, MOST_KEPT / max(known.a, MOST_KEPT));
}

// The value times its certainty, and that, at most 1.
fn recall(known: vec4f) -> vec4f {
  return known / max(known.a, 1.0);
}
