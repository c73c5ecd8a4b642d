// A plate with what is shown of things in the toy's shadow.

// Alpha of such a pixel.
const RELIT: f32 = 0.5;

fn is_relit(plate: vec4f) -> bool {
  return plate.a == RELIT;
}
