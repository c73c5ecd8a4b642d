// Reversed depth: near / metres, 0 for nothing. On a plane it is linear in pixels.

// Relative step of depth that makes an edge between two surfaces.
const DEPTH_STEP: f32 = 0.005;
// The same for the second difference, which a slope does not show.
const DEPTH_BEND: f32 = 0.002;

fn is_same_surface(a: f32, b: f32) -> bool {
  return abs(a - b) <= DEPTH_STEP * max(a, b);
}
