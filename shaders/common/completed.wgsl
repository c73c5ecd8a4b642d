// A plate, completed by a smooth estimate if none was photographed: the lit appearance of the
// receiver, from coarse cells.

//#import common/cells

// Alpha of an estimated pixel: it marks the pixel as such, and is its weight in the fit.
const ESTIMATED: f32 = 0.25;

fn completed(photographed: vec4f, point: ReceiverPoint) -> vec4f {
  if photographed.a == 1.0 { return photographed; }
  return vec4f(cell_at(point).rgb, ESTIMATED);
}
