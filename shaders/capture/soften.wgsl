// The plate, made as soft as the picture: spread by a Gaussian along one axis, and by a second run along the other.
//
// Light is spread, not codes. Places that were not photographed give nothing.
// Reads: the plate as it was taken, or spread along the first axis. Writes: linear colour, alpha as it was.
// CPU reference: tests/reference/src/soften.rs.

//#import common/fullscreen

struct Axis {
  // Of length 1, in pixels.
  direction: vec2f,
  // Standard deviation along it.
  deviation_px: f32,
  _pad: f32,
}

@group(1) @binding(0) var<uniform> axis: Axis;
@group(1) @binding(1) var sharp: texture_2d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;

// Pixels to either side that are looked at.
override REACH_PX: i32 = 12;
// A smaller deviation is that of no spread.
const LEAST_PX: f32 = 0.01;

@fragment
fn fs_soften(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let own = textureLoad(sharp, vec2u(at.xy), 0);
  if own.a == 0.0 || axis.deviation_px < LEAST_PX { return own; }
  let size = vec2f(textureDimensions(sharp));
  let per_px = 1.0 / axis.deviation_px;
  var sum = own;
  for (var k = 1; k <= REACH_PX; k++) {
    let step_px = f32(k);
    let weight = exp(-0.5 * step_px * step_px * per_px * per_px);
    let before = textureSampleLevel(sharp, linear_sampler, (at.xy - step_px * axis.direction) / size, 0.0);
    let behind = textureSampleLevel(sharp, linear_sampler, (at.xy + step_px * axis.direction) / size, 0.0);
    sum += weight * (before + behind);
  }
  return vec4f(sum.rgb / sum.a, own.a);
}
