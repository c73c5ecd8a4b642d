// Grain of computed pixels: the part of the camera's noise that they lack.
//
// The noise of a plate that is a single picture would stand still. So the plate is smoothed where it
// has no more structure than its noise, and grain replaces what is lost. The importing shader declares
// `plate`.
// Source: Lee 1980 (least squares by local mean and variance).

//#import common/globals
//#import common/grain
//#import common/spread

// Whether computed pixels get the camera's noise.
override HAS_GRAIN: bool = false;
// Whether the plate is as sharp as it was taken, and has noise: with grain alone.
override HAS_PLATE_NOISE: bool = false;
// Part of a pixel's variance that may be missing without correction.
const ENOUGH_MISSING: f32 = 0.2;
// Variance of nine pixels over that of their noise below which they have no structure: 1 takes off
// what is noise on average. With 1.5 a plate with 4 codes of noise on a terrazzo is nearer to the
// clean one (RMSE by thirds of its texture 1.89, 2.50 and 3.3 for 1.95, 2.56 and 3.3; 3.5 unsmoothed),
// but a faint texture is lost.
const STRUCTURE: f32 = 1.0;

// Variance that the receiver's pixel lacks, compared with the camera's pixels there.
var<private> missing: vec3f;

// Correlation of neighbours from which on the next but one pixels are taken, which share less of the
// noise. Then the standard deviation of a phone's noise over time (llama, with a STRUCTURE of 1.5), over
// the camera's, is .63 in place of .54 where the old shadow was, and the RMSE is the same.
const CORRELATED: f32 = 0.5;

// Part of the plate's variance that is left where it is smoothed.
var<private> plate_left: f32 = 1.0;
// The plate's pixel before it is smoothed: residuals of single pixels refer to it.
var<private> unsmoothed: vec3f;

// The plate's pixel, smoothed by eight around it as far as their differences are noise. An estimated
// plate has none, and that of a thing is in another light than the camera's noise belongs to.
fn smoothed_plate(texel: vec2u, of_thing: bool) -> vec4f {
  let b = textureLoad(plate, texel, 0);
  unsmoothed = b.rgb;
  if !HAS_PLATE_NOISE { return b; }
  let last = vec2i(globals.region_size_px) - 1;
  let near = correlations_of(drawing.grain_weights);
  let is_far = near.x > CORRELATED;
  let step = select(1, 2, is_far);
  var sum = vec3f(0.0);
  var squares = vec3f(0.0);
  var n = 0.0;
  for (var y = -1; y <= 1; y++) {
    for (var x = -1; x <= 1; x++) {
      let one = textureLoad(plate, clamp(vec2i(texel) + step * vec2i(x, y), vec2i(0), last), 0);
      let apart = one.rgb - b.rgb;
      sum += apart;
      squares += apart * apart;
      n += select(0.0, 1.0, one.a == 1.0);
    }
  }
  let mean = sum / 9.0;
  let seen = dot(squares - 9.0 * mean * mean, vec3f(1.0 / 8.0));
  // Correlations of the pixel with all nine, and of all with each other.
  let of_four_apart = pow(drawing.grain_weights.y, 2.0) / squared_weights(drawing.grain_weights);
  let correlations = select(near, vec2f(near.y, of_four_apart), is_far);
  let with_mean = pow(1.0 + 2.0 * correlations.x, 2.0) / 9.0;
  let of_mean = pow(3.0 + 4.0 * correlations.x + 2.0 * correlations.y, 2.0) / 81.0;
  let noise = dot(variance_of(drawing.plate_noise, b.rgb + mean), vec3f(9.0 / 8.0)) * (1.0 - of_mean);
  // Equal pixels have no structure.
  let structure = select(0.0, max(1.0 - STRUCTURE * noise / seen, 0.0), seen > 0.0);
  let kept = select(1.0, structure, n == 9.0 && !of_thing);
  plate_left = kept * kept + (1.0 - kept) * (2.0 * kept * with_mean + (1.0 - kept) * of_mean);
  return vec4f(b.rgb + (1.0 - kept) * mean, b.a);
}

// Sets the missing variance. `own` is the weight of the frame's pixel `f`; the rest is the plate
// `b` times `lit`. A softened or estimated plate has no noise.
fn missing_beside(color: vec3f, own: f32, f: vec3f, b: vec4f, lit: vec3f) -> vec3f {
  let wanted = variance_of(drawing.frame_noise, color);
  let made = (1.0 - own) * lit;
  let of_plate = select(vec3f(0.0), plate_left * variance_of(drawing.plate_noise, b.rgb), b.a == 1.0 && !is_soft());
  let left = wanted - own * own * variance_of(drawing.frame_noise, f) - made * made * of_plate;
  return select(vec3f(0.0), left, left > ENOUGH_MISSING * wanted);
}

// A colour with noise of this variance and the same mean.
fn grained(color: vec3f, texel: vec2i, variance: vec3f) -> vec3f {
  if all(variance <= vec3f(0.0)) { return color; }
  let at = texel + vec2i(globals.region_origin_px);
  let noise = sqrt(max(variance, vec3f(0.0))) * grain_at(at, drawing.picture, drawing.grain_weights, drawing.channels);
  let room = max(min(color, 1.0 - color), vec3f(0.0));
  return color + clamp(noise, -room, room);
}

// A pixel with this part of a moved toy: its colours are means over neighbours, which have less
// noise. A still surface in other light keeps the camera's.
fn grained_toy(color: vec3f, texel: vec2i, moved: f32) -> vec3f {
  if !HAS_GRAIN { return color; }
  let of_toy = (1.0 - resampled_variance(drawing.grain_weights)) * variance_of(drawing.frame_noise, color);
  return grained(color, texel, mix(missing, of_toy, moved));
}
