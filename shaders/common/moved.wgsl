// Whether a point of the toy has moved on the screen.

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
