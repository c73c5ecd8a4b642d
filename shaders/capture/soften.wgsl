// The plate, made as soft as the picture: a Gaussian spread or a line's, with taps on a grid along its axes.
//
// Linear light is spread, not codes. Places that were not photographed do not contribute. Taps are
// bilinear, so that distances of a little more than a pixel leave no gaps.
// Reads: the plate as photographed. Writes: linear colour, with unchanged alpha.
// CPU reference: tests/reference/src/soften.rs.

//#import common/fullscreen

struct Taps {
  // Distance between taps along each axis, in pixels.
  first_px: vec2f,
  second_px: vec2f,
  // The distances in standard deviations, for the taps' weights; 0 for equal weights.
  spacing: vec2f,
  _pad_0: vec2f,
}

@group(1) @binding(0) var<uniform> taps: Taps;
@group(1) @binding(1) var sharp: texture_2d<f32>;
@group(1) @binding(2) var linear_sampler: sampler;

// Number of taps on each side of the centre, along each axis.
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
