// The picture: plate times new shadow, without real toy and real shadow, under the animated toy.
//   out = gain plate (M' + r)         in general, r the pooled residual, fading with large changes
//   out = frame + gain plate (M' - M) if the receiver is visible and M' is near M: r is the pixel's
//                                     own, so the frame passes; also for unexplained things
//   the mixture of `thing_rim`        at the rim of a thing; the toy over one before it that is lower
//   out = frame + B (M' - M)          clear of toys and shadows, B = frame / (M + r), not a plate
// A glossy receiver's reflection is removed from the frame first, and the shown toy's is added last.
// Reads: all state of the receiver, visibility and ambient of the animated pose, the drawn toy.
// Writes: linear colour, opaque. CPU reference: tests/reference/src/composite.rs.

//#import common/fit
//#import common/frame
//#import common/model
//#import common/pixel
//#import common/cells
//#import common/channels
//#import common/drawn_toy
//#import common/fullscreen
//#import common/layers
//#import common/borders
//#import common/behind_outline
//#import common/made_grain
//#import common/marks
//#import common/reflection
//#import common/relit
//#import common/shadow_strength
//#import common/stillness
//#import common/thing_rim
//#import common/two_receivers
//#import common/unknown

struct Drawing {
  // Whether the own residual of visible pixels is that of `detail` and not the frame's.
  has_detail: u32,
  // Grain: number of the picture; variance of light in frame and plate as (in the dark, for each
  // unit); weights of the pixels one and two away; correlation of a pixel's channels.
  picture: u32,
  frame_noise: vec2f,
  plate_noise: vec2f,
  grain_weights: vec2f,
  channels: f32,
  // Strength of the shown shadow; 1 is the true one.
  strength: f32,
}

// Whether the shown shadow is stronger or weaker than the true one.
override HAS_STRENGTH: bool = false;
// Whether there are several receivers, so that a pixel may show two.
override HAS_EDGES: bool = false;

@group(1) @binding(1) var<storage, read> cells: array<vec4f>;
@group(1) @binding(2) var physical_ambient: texture_2d<f32>;
@group(1) @binding(3) var ambient: texture_2d<f32>;
@group(1) @binding(4) var linear_sampler: sampler;

@group(2) @binding(0) var plate: texture_2d<f32>;
@group(2) @binding(1) var physical_visibility: texture_2d<f32>;
@group(2) @binding(2) var visibility: texture_2d<f32>;
// Each pixel's own residual, in plates.
@group(2) @binding(3) var detail: texture_2d<f32>;
@group(2) @binding(4) var<uniform> drawing: Drawing;

@group(3) @binding(0) var validity: texture_2d<f32>;
// Premultiplied radiance of the toy, with the share of hit samples in alpha, for each draw.
@group(3) @binding(1) var toy_0: texture_2d<f32>;
@group(3) @binding(2) var toy_1: texture_2d<f32>;
@group(3) @binding(3) var toy_2: texture_2d<f32>;
@group(3) @binding(4) var toy_3: texture_2d<f32>;
// Parts of a pixel in which the shown, and the real toy's surface has moved.
@group(3) @binding(5) var toy_moved: texture_2d<f32>;
@group(3) @binding(6) var moved_mask: texture_2d<f32>;
// COVERED_POSITION for each position that the shown toy covers.
@group(3) @binding(7) var covered: texture_2d<f32>;

// Change of the model at which the pooled residual is halved.
const RESIDUAL_HALF: f32 = 0.5;
// Deviation from the model, in plates, up to which a pixel is not affected by the colour of a moved
// toy beside it, and from which it is.
const BLED_NONE: f32 = 0.03;
const BLED_ALL: f32 = 0.1;

// Share of a pixel's colour that is the receiver's own: less beside a toy that has moved.
fn own_share(evident: vec4f, has_moved: bool, deviation: f32) -> f32 {
  if evident.r == 0.0 { return 0.0; }
  if !has_moved { return 1.0; }
  return 1.0 - smoothstep(BLED_NONE, BLED_ALL, deviation);
}

// What is shown of a thing in the toy's shadow: a mixture of the frame `f` and the photographed plate.
fn relit(b: vec4f, f: vec3f) -> vec3f {
  let color = fit.gain.rgb * b.rgb;
  if HAS_GRAIN { missing = missing_beside(color, kept_part(b), f, vec4f(b.rgb, 1.0), fit.gain.rgb); }
  return color;
}

// The receiver's colour. `change` becomes that of the model since the frame `f`, with the weight of
// a camera pixel that mixes toy and receiver in alpha: 1 for a small change. `evident` are the
// marks; `has_moved` is whether the real toy beside it has. `strength` is that of the shadow.
fn receiver(
  position: vec4f,
  f: vec3f,
  evident: vec4f,
  has_moved: bool,
  strength: f32,
  change: ptr<function, vec4f>,
) -> vec3f {
  let texel = vec2u(position.xy);
  let at = position.xy;
  let uv = at / globals.region_size_px;
  let v_before = soft_texel(physical_visibility, vec2i(texel));
  let v_after = shown_visibility(vec2i(texel));
  let a_before = textureSampleLevel(physical_ambient, linear_sampler, uv, 0.0).r;
  let a_after = textureSampleLevel(ambient, linear_sampler, uv, 0.0).r;
  // If no light changes, the other changes are added to the frame: this handles most pixels.
  let is_same = !HAS_STRENGTH && all(v_before == v_after) && a_before == a_after;
  var toward = vec2f(0.0);
  if HAS_EDGES { toward = toward_other(at); }
  if is_same && all(toward == vec2f(0.0)) && evident.r == 1.0 && evident.b > 0.0 && drawing.has_detail == 0u
    && all(beyond == vec3f(0.0)) {
    *change = vec4f(0.0);
    return f;
  }
  // Without a plate and an estimate the frame stays.
  let b = smoothed_plate(texel, is_thing(evident));
  *change = vec4f(0.0, 0.0, 0.0, 1.0);
  if b.a == 0.0 { return f; }
  let lit = fit.gain.rgb * b.rgb;
  let point = receiver_point(at);
  // A thing stays as photographed, but for where the real toy hides it or the toy's shadow moves.
  if is_thing(evident) {
    *change = vec4f(0.0, 0.0, 0.0, 1.0 - evident.b);
    if is_relit(b) { return relit(b, f); }
    let color = mix(lit, f, evident.b);
    if HAS_GRAIN { missing = missing_beside(color, evident.b, f, b, fit.gain.rgb); }
    return color;
  }
  // Beyond the receivers only the real toy is removed; no model tells whether the plate explains the frame.
  if !is_hit(point) {
    *change = vec4f(0.0, 0.0, 0.0, 1.0 - evident.r);
    let color = max(mix(lit + beyond, f + beyond, evident.r), vec3f(0.0));
    if HAS_GRAIN { missing = missing_beside(color, evident.r, f, b, fit.gain.rgb); }
    return color;
  }
  let reflection = fit.gain.rgb * reflected(point, v_before);
  let shown = fit.gain.rgb * reflected_to(globals.camera_in_anchor, point, v_after, min(strength, 1.0));
  let own_color = f - reflection;
  var models = receiver_models(point, vec2f(a_before, a_after), v_before, v_after);
  if HAS_EDGES { models = mixed_models(at, receiver_of(point), toward, vec2f(a_before, a_after), models); }
  var a_shown = a_after;
  if HAS_STRENGTH {
    models[1] = strengthened(receiver_model(point, 1.0, vec4f(1.0)), models[1], strength);
    a_shown = strengthened(vec3f(1.0), vec3f(a_after), strength).r;
  }
  let clipped = fit.receivers[receiver_of(point)].clipped.rgb;
  let before = shown_model(b.rgb, clipped, models[0]);
  let after = shown_model(b.rgb, clipped, models[1]);
  // The strength of an ambient shadow is unknown if there is no other light.
  let darker = select(largest(abs(after - before)), abs(a_shown - a_before), has_no_light());
  let most = max(darker, largest(abs(shown - reflection) / max(lit, vec3f(DARKEST_USABLE))));
  let pooled = cell_at(point).rgb;
  let residual = pooled * (1.0 - smoothstep(0.0, 2.0 * RESIDUAL_HALF, most));
  let is_outlier = outlier(pooled);
  let is_object = is_outlier * (1.0 - shadow_likeness(pooled));
  let off = abs(own_color - lit * (before + pooled));
  let deviation = largest(off / max(lit, vec3f(DARKEST_USABLE)));
  let seen = own_share(evident, has_moved, deviation);
  let is_near = 1.0 - smoothstep(KEEP_ALL, KEEP_NONE, most);
  let is_withheld = evident.a < 1.0 && !is_thing(evident);
  let keep_mixed = select(1.0 - evident.r, 0.0, has_moved || is_withheld) * is_near;
  // Only the plate's light changes along an outline, not what the model does not explain.
  let light = max(after + residual, vec3f(0.0));
  let made = max(lit + beyond, vec3f(0.0)) * light + shown;
  var own = own_color + lit * (after - before);
  if drawing.has_detail == 1u && b.a == 1.0 {
    // Ratios to a nearly black plate are noise.
    let exact = fit.gain.rgb * unsmoothed * (after + textureLoad(detail, texel, 0).rgb);
    own = select(own, exact, unsmoothed >= vec3f(DARKEST_USABLE));
  }
  let own_beyond = explained(off, lit) * light * beyond;
  let kept = mix(darkened(own_color, own, lit * after) + shown + own_beyond, f, is_object);
  let keep = seen * max(is_near, is_outlier);
  let inside = max(inside_border(at), 1.0 - seen);
  *change = vec4f((1.0 - is_object) * (lit * (after - before) + (shown - reflection)), keep_mixed);
  let color = max(mix(f, mix(made, kept, keep), inside), vec3f(0.0));
  if HAS_GRAIN { missing = missing_beside(color, 1.0 - inside * (1.0 - keep), f, b, fit.gain.rgb * (after + residual)); }
  return color;
}

// The picture at a texel with the drawn toy over the receiver of a place: at a rim, a neighbour.
fn over_receiver(texel: vec2i, place: vec2i, toy: vec4f, n_draws: u32) -> vec3f {
  let frame_color = frame_at(place);
  let evident = marks_at(place);
  let in_box = box_texel(texel);
  if toy.a == 1.0 {
    let moved = moved_part(in_box);
    return grained_toy(mix(toy.rgb, frame_color, stillness(in_box, moved)), texel, moved);
  }
  var change = vec4f(0.0);
  let has_moved = evident.b == 0.0 && has_moved_beside(box_texel(place));
  let at = vec4f(vec2f(place) + 0.5, 0.0, 1.0);
  if all(place == texel) { find_beyond(texel, toy.a, evident, has_moved, n_draws); }
  var below = receiver(at, frame_color, evident, has_moved, drawing.strength, &change);
  if is_beside {
    // A camera pixel that stays changes by the means of its spread, as it was.
    var not_of_stays = vec4f(0.0);
    shows_beside = true;
    below = receiver(at, frame_color, evident, has_moved, drawing.strength, &not_of_stays);
    shows_beside = false;
  }
  let laid = (1.0 - toy.a) * below + toy.rgb;
  // Most pixels show the receiver alone and need no test of the toy.
  if change.a == 0.0 { return grained_toy(laid, texel, toy.a); }
  let kept = frame_color + (1.0 - toy.a) * change.rgb;
  let moved = moved_part(in_box);
  let still = stillness(in_box, moved) * change.a;
  missing *= 1.0 - still;
  return grained_toy(max(mix(laid, kept, still), vec3f(0.0)), texel, toy.a * moved);
}

fn composed(position: vec4f, n_draws: u32) -> vec4f {
  let texel = vec2i(position.xy);
  let steps = rim_steps_at(texel);
  let is_rim = any(steps != vec4i(0));
  let is_before = is_before_toy(marks_at(texel));
  let over = over_thing(texel, steps.xy, n_draws);
  if is_before && !is_rim {
    let laid = (1.0 - over.a) * before_toy(texel, frame_at(texel)) + over.rgb;
    return vec4f(grained_toy(laid, texel, over.a), 1.0);
  }
  let toy = toy_layer(box_texel(texel), n_draws);
  // The toy is over the rim of a thing that is not before it, or before its fronts.
  let is_over = is_rim && (!is_before || over.a > OVER_RIM);
  let shown = over_receiver(texel, texel + steps.zw, select(toy, vec4f(0.0), is_over), n_draws);
  if !is_rim { return vec4f(shown, 1.0); }
  let mixed = rim_mixed(texel, steps, shown);
  return vec4f(select(mixed, (1.0 - toy.a) * mixed + toy.rgb, is_over), 1.0);
}

// The plate of a pixel under a model and the pooled residual, from black to white.
fn shown_plate(f: vec3f, model: vec3f) -> vec3f {
  let lit = fit.gain.rgb * model;
  return select(vec3f(1.0), saturate(f / lit), lit > vec3f(0.0));
}

// Pixels clear of the toy in either pose, and of its shadows: the ambient light alone changes.
@fragment
fn fs_open(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let at = position.xy;
  let f = frame_at(vec2i(at));
  let uv = at / globals.region_size_px;
  let a_before = textureSampleLevel(physical_ambient, linear_sampler, uv, 0.0).r;
  let a_after = textureSampleLevel(ambient, linear_sampler, uv, 0.0).r;
  if a_before == a_after { return vec4f(f, 1.0); }
  let point = receiver_point(at);
  if !is_hit(point) { return vec4f(f, 1.0); }
  let models = receiver_models(point, vec2f(a_before, a_after), vec4f(1.0), vec4f(1.0));
  let pooled = cell_at(point).rgb;
  let b = shown_plate(f - fit.gain.rgb * reflected(point, vec4f(1.0)), models[0] + pooled);
  let clipped = fit.receivers[receiver_of(point)].clipped.rgb;
  let change = shown_model(b, clipped, models[1]) - shown_model(b, clipped, models[0]);
  let is_object = outlier(pooled) * (1.0 - shadow_likeness(pooled));
  let relit = f + (1.0 - is_object) * fit.gain.rgb * b * change;
  return vec4f(max(mix(f, relit, inside_border(at)), vec3f(0.0)), 1.0);
}

// Pixels clear of the toy in either pose.
@fragment
fn fs_beside(@builtin(position) position: vec4f) -> @location(0) vec4f {
  var change = vec4f(0.0);
  let color = receiver(position, frame_at(vec2i(position.xy)), FAR_MARKS, false, drawing.strength, &change);
  if !HAS_GRAIN { return vec4f(color, 1.0); }
  return vec4f(grained(color, vec2i(position.xy), missing), 1.0);
}

// Pixels near a toy that was drawn once, or four times, as some processors execute all branches.
@fragment
fn fs_drawn_once(@builtin(position) position: vec4f) -> @location(0) vec4f {
  return composed(position, 1u);
}

@fragment
fn fs_drawn_four_times(@builtin(position) position: vec4f) -> @location(0) vec4f {
  return composed(position, 4u);
}

// The layers of a picture, for a toy that was drawn once, or four times.
@fragment
fn fs_layers_once(@builtin(position) position: vec4f) -> Layers {
  let layers = layered(position, 1u);
  return Layers(layers[0], layers[1], layers[2], layers[3]);
}

@fragment
fn fs_layers_four_times(@builtin(position) position: vec4f) -> Layers {
  let layers = layered(position, 4u);
  return Layers(layers[0], layers[1], layers[2], layers[3]);
}
