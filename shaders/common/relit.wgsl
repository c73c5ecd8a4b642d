// A plate with what is shown of things in the toy's shadow.
//
// Alpha of such a pixel is between those of an estimate and of a photograph: RELIT, and RELIT_RANGE
// times the part that is made, which is above 0; the frame's pixel is the rest.

const RELIT: f32 = 0.5;
const RELIT_RANGE: f32 = 0.25;

// Change of the model, in plates, up to which a visible pixel stays, and from which it is made.
const KEEP_ALL: f32 = 0.02;
const KEEP_NONE: f32 = 0.15;

fn is_relit(plate: vec4f) -> bool {
  return plate.a >= RELIT && plate.a <= RELIT + RELIT_RANGE;
}

// Weight of the frame's pixel in what is shown at such a pixel.
fn kept_part(plate: vec4f) -> f32 {
  return 1.0 - saturate((plate.a - RELIT) / RELIT_RANGE);
}
