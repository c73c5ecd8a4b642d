// The plate, made as soft as the picture: spread by a Gaussian, by taps on a grid along the axes of its spread.
//
// Light is spread, not codes. Places that were not photographed give nothing. Taps are bilinear, so that those which are not much
// more than a pixel apart leave no gaps.
// Reads: the plate as it was taken. Writes: linear colour, alpha as it was. CPU reference: tests/reference/src/soften.rs.

//#import common/fullscreen

struct Taps {
  // From one tap to the next along each axis, in pixels.
  first_px: vec2f,
  second_px: vec2f,
  // The same in standard deviations.
  spacing: f32,
  _pad_0: f32,
  _pad_1: vec2f,
}

@group(1) @binding(0) var<uniform> taps: Taps;
@group(1) @binding(1) var sharp: texture_2d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;

// Taps to either side of the middle, along each axis.
override N_BESIDE: i32 = 3;

@fragment
fn fs_soften(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let own = textureLoad(sharp, vec2u(at.xy), 0);
  if own.a == 0.0 { return own; }
  let per_px = 1.0 / vec2f(textureDimensions(sharp));
  var sum = vec4f(0.0);
  for (var j = -N_BESIDE; j <= N_BESIDE; j++) {
    for (var i = -N_BESIDE; i <= N_BESIDE; i++) {
      let deviations = taps.spacing * vec2f(f32(i), f32(j));
      let tap_px = at.xy + f32(i) * taps.first_px + f32(j) * taps.second_px;
      let weight = exp(-0.5 * dot(deviations, deviations));
      sum += weight * textureSampleLevel(sharp, linear_sampler, tap_px * per_px, 0.0);
    }
  }
  return vec4f(sum.rgb / sum.a, own.a);
}
