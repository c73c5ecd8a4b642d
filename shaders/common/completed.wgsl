// A plate, completed by a smooth estimate if none was photographed: the lit appearance of the
// receiver, from coarse cells. Pixels with the receiver's pattern (`things`) stay as they are.

//#import common/cells
//#import common/estimated

fn completed(photographed: vec4f, point: ReceiverPoint) -> vec4f {
  if photographed.a == ESTIMATED || photographed.a == 1.0 { return photographed; }
  return vec4f(cell_at(point).rgb, ESTIMATED);
}
