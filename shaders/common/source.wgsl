// The pixel near a pixel of the physical box from which its colour comes.

//#import common/globals

// Largest distance to a pixel of one surface.
const REACH_PX: i32 = 3;
// Pixels around a pixel are numbered row by row, with this number per row.
const N_IN_ROW: i32 = 8;
// Number of a pixel without a colour.
const NO_SOURCE: u32 = 255u;

fn number_of(offset: vec2i) -> u32 {
  return u32((offset.y + REACH_PX) * N_IN_ROW + offset.x + REACH_PX);
}

fn source_of(number: u32) -> vec4f {
  return vec4f(f32(number) / 255.0, 0.0, 0.0, 0.0);
}

// Texel of the source with this number.
fn source_texel(texel: vec2i, number: u32) -> vec2i {
  let place = vec2i(vec2u(number % u32(N_IN_ROW), number / u32(N_IN_ROW)));
  return clamped_to_physical_box(texel + place - REACH_PX);
}

// Number in a texel of a source.
fn number_at(source: vec4f) -> u32 {
  return u32(round(255.0 * source.r));
}
