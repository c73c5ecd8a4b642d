// A plate, completed by a smooth estimate where none was photographed: what the receiver looks like in the light, of coarse cells.

//#import common/cells

// Alpha of an estimated pixel: marks it as such, and is its weight in the fit.
const ESTIMATED: f32 = 0.25;

fn completed(photographed: vec4f, point: ReceiverPoint) -> vec4f {
  if photographed.a == 1.0 { return photographed; }
  return vec4f(cell_at(point).rgb, ESTIMATED);
}
