// The toy's shadow on things that stand on the first receiver.
//
// A point of a thing, at a known height, is in the toy's shadow if the receiver is at the place
// where the ray from the light through the point meets it. So the receiver's visibilities tell the
// thing's, too. (They are wrong if the toy is behind the thing, as the light sees it.)
//
//   out = gain plate (1 - sum s (1 - intensity V'))     where V' differs from V nearby, or where the
//                                                      real toy hides the thing
//   out = frame                                        elsewhere
//
// s is a light's share of the point's light in the plate: the marks have the sum of all, which is
// divided as on the receiver, up to all of the light in a channel.
//
// Reads: frame, plate, validity, visibilities of both poses, marks of things with heights. Writes:
// the plate; at a thing in the toy's shadow what is shown there, over the gain, with the alpha of
// `relit`. Where something else hides the thing, such as a person, the plate stays.
// CPU reference: tests/reference/src/on_things.rs.

//#import common/channels
//#import common/fit
//#import common/frame
//#import common/fullscreen
//#import common/marks
//#import common/relit
//#import common/thing_marks

@group(1) @binding(2) var plate: texture_2d<f32>;
@group(1) @binding(3) var physical_visibility: texture_2d<f32>;
@group(1) @binding(4) var visibility: texture_2d<f32>;
@group(1) @binding(5) var validity: texture_2d<f32>;

// Distance in pixels at which a change of the visibility counts, too: a height that is off moves the
// place at which the receiver is looked up, and a penumbra with it.
const NEARBY_PX: f32 = 3.0;
const FAR_PX: f32 = 100.0;

// Height above the receiver, in metres, and the lights' share of the light.
fn raised(mark: vec4f) -> vec2f {
  let codes = round(255.0 * mark.gb);
  return vec2f((256.0 * codes.x + codes.y) * HEIGHT_STEP_M, mark.a);
}

// The point of the first receiver's plane that is seen at a pixel, as (x, z), and 1; 0 if there is
// none.
fn seen_below(region_px: vec2f) -> vec3f {
  let p = globals.receivers[0].plane_from_region_px * vec3f(region_px, 1.0);
  if p.z <= 0.0 { return vec3f(0.0); }
  return vec3f(p.xy / p.z, 1.0);
}

// Pixel at which the receiver has the shadow that light `i` casts at a point in anchor space;
// far outside the region if there is none.
fn shadow_px(i: u32, point: vec3f) -> vec2f {
  let light = globals.lights[i];
  let to_light = light.xyz - light.w * point;
  if to_light.y <= 0.0 { return vec2f(-FAR_PX); }
  let below = point - point.y / to_light.y * to_light;
  return region_px_of(point_on(0u, below.xz));
}

// Visibilities of light `i` before and after at a texel that shows the first receiver; 1 elsewhere.
fn visible_texel(i: u32, texel: vec2i) -> vec2f {
  if any(texel < vec2i(0)) || any(texel >= vec2i(globals.region_size_px)) { return vec2f(1.0); }
  if receiver_of(receiver_point(vec2f(texel) + 0.5)) != 0u { return vec2f(1.0); }
  return vec2f(textureLoad(physical_visibility, texel, 0)[i], textureLoad(visibility, texel, 0)[i]);
}

// The same at a place between texels.
fn visible_at(i: u32, region_px: vec2f) -> vec2f {
  let corner = floor(region_px - 0.5);
  let part = region_px - 0.5 - corner;
  let texel = vec2i(corner);
  let above = mix(visible_texel(i, texel), visible_texel(i, texel + vec2i(1, 0)), part.x);
  let below = mix(visible_texel(i, texel + vec2i(0, 1)), visible_texel(i, texel + vec2i(1, 1)), part.x);
  return mix(above, below, part.y);
}

// The same for the point itself, and the largest difference of both around it.
fn visible_around(i: u32, region_px: vec2f) -> vec3f {
  let here = visible_at(i, region_px);
  var most = abs(here.x - here.y);
  for (var k = 0; k < 4; k++) {
    let side = NEARBY_PX * f32(2 * (k & 1) - 1);
    let there = visible_at(i, region_px + select(vec2f(side, 0.0), vec2f(0.0, side), k < 2));
    most = max(most, abs(there.x - there.y));
  }
  return vec3f(here, most);
}

@fragment
fn fs_shade(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2u(position.xy);
  let b = textureLoad(plate, texel, 0);
  let mark = mark_at(position.xy);
  let code = code_of(mark);
  let of_thing = raised(mark);
  let is_raised = (code == CODE_THING || code == CODE_BEFORE_TOY) && of_thing.x > 0.0;
  let below = seen_below(position.xy);
  let eye = globals.camera_in_anchor;
  if !is_raised || b.a < 1.0 || below.z == 0.0 || of_thing.x >= eye.y { return b; }
  let marks = marks_at(vec2i(texel));
  if is_before_thing(marks) { return b; }
  let point = mix(vec3f(below.x, 0.0, below.y), eye, of_thing.x / eye.y);
  var total = vec3f(0.0);
  for (var i = 0u; i < globals.n_lights; i++) { total += fit.receivers[0].direct_fraction[i].rgb; }
  let mean = (total.r + total.g + total.b) / 3.0;
  if mean <= 0.0 { return b; }
  let of_all = min(of_thing.y * total / mean, vec3f(1.0));
  let scale = select(vec3f(0.0), of_all / total, total > vec3f(0.0));
  var left = vec3f(1.0);
  var change = vec3f(0.0);
  for (var i = 0u; i < globals.n_lights; i++) {
    let share = scale * fit.receivers[0].direct_fraction[i].rgb;
    let seen = visible_around(i, shadow_px(i, point));
    left -= share * (1.0 - fit.intensity[i].rgb * seen.y);
    change += share * fit.intensity[i].rgb * seen.z;
  }
  // The frame shows the real toy or its rim there, if that is not behind the thing.
  let hidden = select(0.0, 1.0 - marks.b, code == CODE_THING);
  let made = max(smoothstep(KEEP_ALL, KEEP_NONE, largest(change)), hidden);
  if made == 0.0 { return b; }
  let f = frame_at(vec2i(texel));
  let shown = mix(f / fit.gain.rgb, b.rgb * max(left, vec3f(0.0)), made);
  return vec4f(shown, RELIT + RELIT_RANGE * made);
}
