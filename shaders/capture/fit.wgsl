// Sums of the weighted normal equations, for a receiver, for the toy, or for gain and intensities.
//
// Receiver: frame / gain = plate c (A + bounce A (1 - A)
//   + sum_i fraction_i falloff_i (intensity_i V_i - A) / plate_falloff)
// is linear in (c, c bounce, c fraction_i), with plate_falloff and gain of the previous step; c
// corrects the gain. The receiver's reflection, relative to the gain, is subtracted from the left
// side, and is a part of the gain's column in the fit of intensities. Without any light the first
// two columns add up to the plate, and a third one contains the difference of the frame.
// Toy: frame / gain = base (toy_0 (1 + n.y) / 2 + toy_1 (1 - n.y) / 2 + sum_i toy_i intensity_i
// max(n.l_i, 0) V_i), V_i with self-shadowing; a glossy toy adds its reflection of each, relative
// to its base.
// Intensities: frame = gain plate (ambient_part + sum_i intensity_i f_i V_i) is linear in (gain,
// gain intensity_i). Nothing is divided by plate or base, so dark texels have little weight.
// Weights are Cauchy's, from the previous step. Sums run over pixels here and over workgroups in
// `fit_solve`.
//
// Reads: lit cells, frame, plate, validity, visibility, ambient, gbuffer. Writes: rows of 28 sums,
// one per workgroup and channel.
// CPU reference: tests/reference/src/fit.rs. Source: Holland and Welsch 1977 (iteratively
// reweighted least squares).

//#import common/fit
//#import common/frame
//#import common/fit_step
//#import common/model
//#import common/toy_radiance
//#import common/pixel
//#import common/reflection
//#import common/marks
//#import common/completed
//#import common/fit_sums
//#import common/gloss
//#import common/toy_point

// The lit cells from which the plate is completed.
@group(1) @binding(1) var<storage, read> cells: array<vec4f>;

@group(2) @binding(0) var<uniform> step: FitStep;
@group(2) @binding(1) var<storage, read_write> rows: array<f32>;
@group(2) @binding(2) var plate: texture_2d<f32>;
@group(2) @binding(3) var validity: texture_2d<f32>;
@group(2) @binding(4) var visibility: texture_2d<f32>;
@group(2) @binding(5) var ambient: texture_2d<f32>;
@group(2) @binding(6) var ambient_sampler: sampler;
@group(2) @binding(7) var gbuffer_base: texture_2d<f32>;
@group(2) @binding(8) var gbuffer_normal: texture_2d<f32>;
// Each light's cosine times its visibility.
@group(2) @binding(9) var gbuffer_received: texture_2d<f32>;
@group(2) @binding(10) var gbuffer_depth: texture_depth_2d;
@group(2) @binding(11) var<uniform> specular: Specular;

// Residual, as a fraction of plate or base, at which a pixel's weight is one half.
const CAUCHY_SCALE: f32 = 0.03;
// The same for the toy, whose interreflections and curved faces are not modelled.
const TOY_CAUCHY_SCALE: f32 = 0.12;
// Weight of an estimated plate in the fit of the intensities: it counts if there is no photographed
// one. Its errors would otherwise act as another gain, which would enter the next view's estimate.
const ESTIMATED_INTENSITIES: f32 = 1e-3;

fn cauchy_weight(residual: vec3f, scale: vec3f) -> vec3f {
  let r = residual / scale;
  return select(1.0 / (1.0 + r * r), vec3f(0.0), scale == vec3f(0.0));
}

// Measurements at a pixel of a receiver: the inputs of its equations.
struct Observation {
  point: ReceiverPoint,
  frame: vec3f,
  plate: vec3f,
  ambient: f32,
  visibility: vec4f,
  // Light that the receiver reflects, relative to the gain.
  reflected: vec3f,
  // 0 if the pixel is masked out or unusable.
  weight: vec3f,
  // 1 if frame and plate may both be clipped.
  clipped: vec3f,
  // Whether the plate there is an estimate, made with the previous intensities.
  is_estimated: bool,
}

fn plate_at(texel: vec2u) -> vec4f {
  return textureLoad(plate, texel, 0);
}

// The same, completed by an estimate: the best plate before the fits.
fn completed_at(texel: vec2u) -> vec4f {
  let photographed = plate_at(texel);
  let point = receiver_point(vec2f(texel) + 0.5);
  if !is_hit(point) { return photographed; }
  return completed(photographed, point);
}

fn observe(texel: vec2u, plate_texel: vec4f) -> Observation {
  var seen: Observation;
  let at = vec2f(texel) + 0.5;
  let evident = marks_at(vec2i(texel)).r;
  seen.point = receiver_point(at);
  if evident == 0.0 || !is_hit(seen.point) { return seen; }
  seen.frame = frame_at(vec2i(texel));
  seen.plate = plate_texel.rgb;
  seen.ambient = textureSampleLevel(ambient, ambient_sampler, at / globals.region_size_px, 0.0).r;
  seen.visibility = textureLoad(visibility, texel, 0);
  seen.reflected = reflected(seen.point, seen.visibility);
  seen.is_estimated = plate_texel.a < 1.0;
  seen.clipped = is_clipped(seen.frame, seen.plate);
  seen.weight = evident * plate_texel.a * evidence_of(seen.frame, seen.plate);
  return seen;
}

fn receiver_equation(seen: Observation) -> Equation {
  var eq: Equation;
  if all(seen.weight == vec3f(0.0)) || receiver_of(seen.point) != step.receiver { return eq; }
  let b = seen.plate;
  var total = open_sky(seen.point) * ambient_fraction(step.receiver);
  eq.value = seen.frame / fit.gain.rgb - seen.reflected;
  eq.columns[0] = b * seen.ambient;
  eq.columns[1] = b * bounced(seen.ambient);
  var predicted = eq.columns[0] + fit.receivers[step.receiver].bounce.rgb * eq.columns[1];
  // The loop does not end at the number of lights, so that no column is indexed dynamically.
  for (var i = 0u; i < MAX_LIGHTS; i++) {
    if i >= globals.n_lights { continue; }
    // Such a pixel counts as equally bright in shadow; if a shadow is visible there, it is an
    // outlier.
    let lit = (1.0 - seen.clipped) * seen.visibility[i];
    let visible = fit.intensity[i].rgb * lit - seen.ambient;
    let here = falloff(i, seen.point);
    total += fit.receivers[step.receiver].direct_fraction[i].rgb * here;
    eq.columns[2u + i] = b * here * visible;
  }
  for (var i = 0u; i < MAX_LIGHTS; i++) {
    if i >= globals.n_lights { continue; }
    eq.columns[2u + i] /= total;
    predicted += fit.receivers[step.receiver].direct_fraction[i].rgb * eq.columns[2u + i];
  }
  if has_no_light() { eq.columns[UNSHADED_COLUMN] = eq.value - b; }
  eq.weight = seen.weight;
  eq.clipped = seen.clipped;
  if step.is_reweighted == 1u { eq.weight *= cauchy_weight(eq.value - predicted, CAUCHY_SCALE * b); }
  return eq;
}

fn intensity_equation(seen: Observation) -> Equation {
  var eq: Equation;
  if all(seen.weight == vec3f(0.0)) { return eq; }
  let b = seen.plate;
  let total = plate_falloff(seen.point);
  eq.value = seen.frame;
  eq.columns[0] = b * ambient_part(seen.point, seen.ambient, total) + seen.reflected;
  var predicted = eq.columns[0];
  for (var i = 0u; i < MAX_LIGHTS; i++) {
    if i >= globals.n_lights { continue; }
    let column = b * light_part(i, seen.point, total) * seen.visibility[i];
    predicted += fit.intensity[i].rgb * column;
    if !seen.is_estimated { eq.columns[2u + i] = column; }
  }
  // An estimated plate constrains the gain alone.
  if seen.is_estimated { eq.columns[0] = predicted; }
  let gain = fit.gain.rgb;
  eq.weight = seen.weight * select(1.0, ESTIMATED_INTENSITIES, seen.is_estimated);
  if step.is_reweighted == 1u { eq.weight *= cauchy_weight(eq.value - gain * predicted, CAUCHY_SCALE * gain * b); }
  return eq;
}

fn toy_equation(texel: vec2u) -> Equation {
  var eq: Equation;
  if marks_at(vec2i(texel)).g == 0.0 { return eq; }
  let in_box = physical_texel(vec2i(texel));
  let base = textureLoad(gbuffer_base, in_box, 0).rgb;
  let f = frame_at(vec2i(texel));
  let surface = textureLoad(gbuffer_normal, in_box, 0);
  let normal = surface.xyz;
  let strength = strength_of(u32(surface.w));
  eq.value = f / fit.gain.rgb;
  let received = textureLoad(gbuffer_received, in_box, 0);
  let part = hemispheres(normal);
  eq.columns[0] = base * part.x;
  eq.columns[1] = base * part.y;
  for (var i = 0u; i < MAX_LIGHTS; i++) {
    if i < globals.n_lights { eq.columns[2u + i] = base * fit.intensity[i].rgb * received[i]; }
  }
  var predicted = base * toy_radiance_over_base(normal, received);
  var scale = TOY_CAUCHY_SCALE * base;
  if strength > 0.0 {
    let point = seen_in_anchor(vec2f(texel) + 0.5, textureLoad(gbuffer_depth, in_box, 0));
    let to_camera = direction_to_camera(point);
    let ambient = strength * reflected_ambient(normal, to_camera);
    eq.columns[0] += vec3f(ambient.x);
    eq.columns[1] += vec3f(ambient.y);
    for (var i = 0u; i < MAX_LIGHTS; i++) {
      if i >= globals.n_lights || received[i] == 0.0 { continue; }
      let of_light = strength * received[i] * reflected_light(i, normal, to_camera, point);
      eq.columns[2u + i] += fit.intensity[i].rgb * of_light;
    }
    predicted += strength * (reflected_of_ambient(normal, point) + reflected_of_lights(normal, point, received));
    scale += TOY_CAUCHY_SCALE * (ambient.x + ambient.y);
  }
  // A clipped toy is at least this bright, if no other pixel constrains its light.
  eq.weight = evidence_of(f, f);
  if step.is_reweighted == 1u { eq.weight *= cauchy_weight(eq.value - predicted, scale); }
  return eq;
}

fn sampled_size() -> vec2u {
  return vec2u(globals.region_size_px) / step.stride_px;
}

fn n_sampled() -> u32 {
  let size = sampled_size();
  return size.x * size.y;
}

fn sampled_texel(index: u32) -> vec2u {
  let width = sampled_size().x;
  return vec2u(index % width, index / width) * step.stride_px;
}

// There is an entry point for each subject, and for each kind of plate, since some processors
// execute all branches of a shader.
@compute @workgroup_size(WORKGROUP)
fn cs_receiver(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  for (var index = group.x * WORKGROUP + lane; index < n_sampled(); index += step.n_rows * WORKGROUP) {
    let texel = sampled_texel(index);
    add(receiver_equation(observe(texel, plate_at(texel))));
  }
  reduce(group.x, lane);
}

@compute @workgroup_size(WORKGROUP)
fn cs_receiver_completing(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  for (var index = group.x * WORKGROUP + lane; index < n_sampled(); index += step.n_rows * WORKGROUP) {
    let texel = sampled_texel(index);
    add(receiver_equation(observe(texel, completed_at(texel))));
  }
  reduce(group.x, lane);
}

@compute @workgroup_size(WORKGROUP)
fn cs_toy(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  // Only sampled pixels in the physical box count.
  let low = vec2u(globals.physical_box_origin_px);
  let first = (low + step.stride_px - 1u) / step.stride_px;
  let end = (low + vec2u(globals.physical_box_size_px) + step.stride_px - 1u) / step.stride_px;
  let size = min(end, sampled_size()) - min(first, sampled_size());
  for (var index = group.x * WORKGROUP + lane; index < size.x * size.y; index += step.n_rows * WORKGROUP) {
    add(toy_equation((first + vec2u(index % size.x, index / size.x)) * step.stride_px));
  }
  reduce(group.x, lane);
}

@compute @workgroup_size(WORKGROUP)
fn cs_intensities(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  for (var index = group.x * WORKGROUP + lane; index < n_sampled(); index += step.n_rows * WORKGROUP) {
    let texel = sampled_texel(index);
    add(intensity_equation(observe(texel, plate_at(texel))));
  }
  reduce(group.x, lane);
}

@compute @workgroup_size(WORKGROUP)
fn cs_intensities_completing(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
  for (var index = group.x * WORKGROUP + lane; index < n_sampled(); index += step.n_rows * WORKGROUP) {
    let texel = sampled_texel(index);
    add(intensity_equation(observe(texel, completed_at(texel))));
  }
  reduce(group.x, lane);
}
