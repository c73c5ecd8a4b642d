// Whether a point of the toy has moved on the screen, or changed its light.

//#import common/globals

// Distance in pixels up to which a point counts as still, and from which as moved.
const STILL_PX: f32 = 0.05;
const MOVED_PX: f32 = 0.2;

fn region_px(clip: vec4f) -> vec2f {
  return (clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5) * globals.region_size_px;
}

fn moved(shown_px: vec2f, physical_px: vec2f) -> f32 {
  return smoothstep(STILL_PX, MOVED_PX, distance(shown_px, physical_px));
}

// A still point whose light has changed is written as a smaller part than that of one moved sample of
// four: at most this part.
const RELIT_CODES: f32 = 31.0;
const ALL_RELIT: f32 = RELIT_CODES / 255.0;

// The written part of a point that has moved, or else changed its light, in these parts.
fn written_change(moved: f32, relit: f32) -> f32 {
  return max(moved, ALL_RELIT * relit);
}

// The moved part of a written one.
fn moved_of(written: f32) -> f32 {
  return select(0.0, written, round(255.0 * written) > RELIT_CODES);
}

// The part that is moved or relit of a written one.
fn changed_of(written: f32) -> f32 {
  return min(written / ALL_RELIT, 1.0);
}
