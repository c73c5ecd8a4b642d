// Pixels at the rim of a thing, which mix it with what is beyond it.
//
//   frame = part x thing + (1 - part) x beyond          part by least squares, in frame and plate
//   out   = part x thing' + (1 - part) x beyond'
// The thing's colour is that of a pixel within it, what is beyond that of a pixel on the other side.
// What is left of the frame after this mixture is kept where what is beyond stays as it is.
//
// The importing shader declares `plate`.
// Source: Chuang et al. 2001 (matting: the part of a known foreground over a known background).

//#import common/channels
//#import common/fit
//#import common/frame
//#import common/marks
//#import common/pixel
//#import common/relit

// Squared difference of colours, summed over frame and plate, that tells as much about the part as the
// side of the mark on which the pixel lies: that of a noise of four codes. With .03 and .003 the RMS
// error at the toy's edge is 4.99 and 4.90 codes behind a post, 2.66 and 2.61 behind a cup.
const RIM_CONTRAST: f32 = 0.003;
// Part of a pixel on either side of the mark that shows the thing, if colours do not tell.
const PART_INSIDE: f32 = 0.75;

// Colours of the plate in a pixel, within the thing, and beyond it, if all were photographed and
// nothing is changed there: differences from the last one, 0 otherwise.
fn plate_differences(texel: vec2i, steps: vec4i) -> mat2x3f {
  let here = textureLoad(plate, texel, 0);
  let within = textureLoad(plate, texel + steps.xy, 0);
  let beyond = textureLoad(plate, texel + steps.zw, 0);
  if min(min(here.a, within.a), beyond.a) < 1.0 { return mat2x3f(vec3f(0.0), vec3f(0.0)); }
  return mat2x3f(here.rgb - beyond.rgb, within.rgb - beyond.rgb);
}

// The pixel with `shown` beyond the thing. `steps` lead within the thing and beyond it.
fn rim_mixed(texel: vec2i, steps: vec4i, shown: vec3f) -> vec3f {
  let here = frame_at(texel);
  let within = frame_at(texel + steps.xy);
  let beyond = frame_at(texel + steps.zw);
  let in_plate = plate_differences(texel, steps);
  let is_inside = dot(steps.xy, steps.xy) < dot(steps.zw, steps.zw);
  let prior = select(1.0 - PART_INSIDE, PART_INSIDE, is_inside);
  let along = dot(here - beyond, within - beyond) + dot(in_plate[0], in_plate[1]) + RIM_CONTRAST * prior;
  let whole = dot(within - beyond, within - beyond) + dot(in_plate[1], in_plate[1]) + RIM_CONTRAST;
  let part = saturate(along / whole);
  let change = largest(abs(shown - beyond)) / max(largest(max(shown, beyond)), DARKEST_USABLE);
  let remainder = (1.0 - smoothstep(KEEP_ALL, KEEP_NONE, change)) * (here - mix(beyond, within, part));
  let kept = max(mix(shown, within, part) + remainder, vec3f(0.0));
  let relit_within = textureLoad(plate, texel + steps.xy, 0);
  if !is_relit(relit_within) { return kept; }
  return mix(mix(shown, fit.gain.rgb * relit_within.rgb, part), kept, kept_part(relit_within));
}

// A thing before the toy, in the toy's shadow or not.
fn before_toy(texel: vec2i, f: vec3f) -> vec3f {
  let b = textureLoad(plate, texel, 0);
  if !is_relit(b) { return f; }
  return relit(b, f);
}
