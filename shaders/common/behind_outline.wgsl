// The background of a soft outline.
//
// A blurred picture mixes the toy with the background that it leaves free. The mean of the softened
// plate is over all positions of the spread, so that it also has what the toy hides. Therefore the plate
// is taken at the middle of the free positions.
// The importing shader declares `plate`, and those of `drawn_toy`.

//#import common/drawn_toy
//#import common/fit
//#import common/globals
//#import common/spread

// Rows of the lattice from one column's position to the next.
const OUTLINE_ROW_STEP: u32 = 9u;

// The plate's colour between four texels, `at` texels from the middle of the region's first, and their
// least alpha.
fn plate_between(at: vec2f) -> vec4f {
  let low = floor(at);
  let t = at - low;
  let last = vec2i(globals.region_size_px) - 1;
  var sum = vec3f(0.0);
  var least = 1.0;
  for (var k = 0u; k < 4u; k++) {
    let corner = vec2f(vec2u(k & 1u, k >> 1u));
    let weight = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
    let one = textureLoad(plate, clamp(vec2i(low + corner), vec2i(0), last), 0);
    sum += weight * one.rgb;
    least = min(least, one.a);
  }
  return vec4f(sum, least);
}

// Middle of the positions around a texel of the toy box that the toy leaves free, in pixels from its own.
fn middle_of_free_px(in_box: vec2i, n_draws: u32) -> vec2f {
  var sum = vec3f(0.0);
  for (var k = 0u; k < N_POSITIONS; k++) {
    let lattice = vec2f(vec2u(k, k * OUTLINE_ROW_STEP % N_POSITIONS)) + 0.5;
    let from_px = spread_position_px(lattice / f32(N_POSITIONS));
    let tap = clamped_to_box(in_box + vec2i(floor(from_px + 0.5)));
    sum += (1.0 - drawn_toy(tap, n_draws).a) * vec3f(from_px, 1.0);
  }
  return select(vec2f(0.0), sum.xy / sum.z, sum.z > 0.0);
}

// The background at a texel of the region, at the toy's soft outline, if `color` is its colour by the plate
// at the texel itself. It changes as the plate does, in as much light as falls there, at most all of it: a
// factor would be without limit on a dark plate. It stays where plates do not show the place.
fn behind_outline(texel: vec2i, color: vec3f, n_draws: u32) -> vec3f {
  let own = textureLoad(plate, texel, 0);
  let free = plate_between(vec2f(texel) + middle_of_free_px(box_texel(texel), n_draws));
  let lit = dot(fit.gain.rgb, own.rgb);
  if free.a < 1.0 || lit <= 0.0 { return color; }
  let left = min(dot(color, vec3f(1.0)) / lit, 1.0);
  return max(color + left * fit.gain.rgb * (free.rgb - own.rgb), vec3f(0.0));
}
