// Reversed depth: near / metres, 0 where there is nothing.

// Relative step of depth between neighbours that makes an edge between two surfaces.
const DEPTH_STEP: f32 = 0.01;

fn is_same_surface(a: f32, b: f32) -> bool {
  return abs(a - b) <= DEPTH_STEP * max(a, b);
}
