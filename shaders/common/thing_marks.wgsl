// Marks of things, which belong to the picture in which they were found and are transferred by the
// first receiver's plane.

struct ThingsView {
  // Homography to the marks' pixels: (u, v, w) for a pixel of the region, with w > 0 in front of
  // their camera.
  marks_px_from_region_px: mat3x3f,
}

@group(1) @binding(0) var<uniform> things: ThingsView;
// Codes of marks, and light as a share of what is usual; for a point of a thing above the receiver
// its height in two codes, the higher one first, and the lights' share of its light in the plate.
@group(1) @binding(1) var codes: texture_2d<f32>;

const CODE_THING: u32 = 1u;
const CODE_BEFORE_TOY: u32 = 2u;
const CODE_WRONG_PLATE: u32 = 3u;
const CODE_SHADED_PLATE: u32 = 4u;
const CODE_HIDDEN_THING: u32 = 5u;
const CODE_PAINTED_THING: u32 = 6u;
const CODE_COMPLETED_PLATE: u32 = 7u;
// Light of a painted thing with the largest codes, whose squares are proportional to light.
const MOST_PAINTED: f32 = 16.0;
// The same of a completed plate.
const MOST_COMPLETED: f32 = 64.0;
// Height of a code of 1 in the lower one.
const HEIGHT_STEP_M: f32 = 1e-5;

// The mark at a place: its code, and light; 0 outside their picture.
fn mark_at(region_px: vec2f) -> vec4f {
  let at = things.marks_px_from_region_px * vec3f(region_px, 1.0);
  if at.z <= 0.0 { return vec4f(0.0); }
  let texel = vec2i(floor(at.xy / at.z));
  if any(texel < vec2i(0)) || any(texel >= vec2i(textureDimensions(codes))) { return vec4f(0.0); }
  return textureLoad(codes, texel, 0);
}

fn code_of(mark: vec4f) -> u32 {
  return u32(round(255.0 * mark.r));
}
