// Solves the normal equations of `fit` per channel, with weak priors for under-constrained unknowns.
//
// A toy with few faces does not separate its lights from the ambient light. The receiver does: its
// ambient part is to a light's part as the ambient light from above on the toy is to that light,
// and it reflects the light from below. A negative unknown becomes 0, and the others are solved
// again.
//
// If no light is known, the share of ambient light is unknown, too: the toy casts a shadow of it
// only if this explains a part of the difference between frame and plate.
//
// Reads: rows of sums, and those accumulated over earlier frames, since scene and toy do not depend
// on the camera.
// Writes: the solution, and in the last step the accumulated sums.
// CPU reference: tests/reference/src/fit.rs. Source: Lawson and Hanson 1974, 23 (non-negative least
// squares); here unknowns are only removed, the most negative one first.

//#import common/accumulated
//#import common/fit
//#import common/fit_row
//#import common/fit_step
//#import common/receiver_light
//#import common/no_light

@group(1) @binding(0) var<uniform> step: FitStep;
@group(1) @binding(1) var<storage, read> rows: array<f32>;
@group(1) @binding(2) var<storage, read_write> solution: Fit;
// 84 sums for each receiver, followed by those for the toy.
@group(1) @binding(3) var<storage, read_write> accumulated: array<f32>;

// Number of sums of the three channels.
const N_ROW: u32 = 84u;
// Weight of the priors relative to the energy of the first column.
const PRIOR_WEIGHT: f32 = 1e-4;
// Weight of a light's previous intensity, relative to the energy of the ambient light.
const INTENSITY_WEIGHT: f32 = 1e-3;
// Weight of the first receiver's gain for the other receivers: there is one exposure.
const SAME_GAIN_WEIGHT: f32 = 10.0;
// Weight of the three channels' common solution for the toy, relative to their common energy.
const WHITE_WEIGHT: f32 = 0.003;
// Weight of the receiver's constraint on the toy's light, relative to the toy's energy.
const RECEIVER_LIGHT_WEIGHT: f32 = 0.01;
// Bounce of a toy of middle grey: the mean over channels in sessions of the bundled toy.
const PRIOR_BOUNCE: f32 = 0.27;
// Direct fraction of all lights together, half of the plate's radiance; each as if of equal intensity at one metre.
const PRIOR_DIRECT_FRACTION: f32 = 0.5;
// Direct fractions sum to less than 1, since some light is always ambient: with LEAST_SKY it keeps plate_falloff positive.
const MAX_DIRECT_FRACTION: f32 = 0.98;
const MAX_BOUNCE: f32 = 1.0;

var<workgroup> sums: array<f32, N_ROW>;
// Used by one invocation alone; as private arrays they keep phones' compilers busy for minutes, and spill.
var<workgroup> matrix: array<f32, 36>;
var<workgroup> unknowns: array<f32, N_COLUMNS>;
// The equations before unknowns are taken out.
var<workgroup> whole: array<f32, 36>;
var<workgroup> right: array<f32, N_COLUMNS>;

// Irradiance of a light on a receiver's reference point, up to a factor of the light.
fn irradiance(receiver: u32, i: u32) -> f32 {
  let to_light = reference_to_light(receiver, i);
  if to_light.y <= 0.0 { return 0.0; }
  if globals.receivers[receiver].lights[i].w == 0.0 { return to_light.y; }
  let distance_m = length(to_light);
  return to_light.y / (distance_m * distance_m * distance_m);
}

// A light's irradiance on the fitted receiver, relative to that on the first.
fn of_first(i: u32) -> f32 {
  let first = irradiance(0u, i);
  return select(0.0, irradiance(step.receiver, i) / first, first > 0.0);
}

// Prior of a light's direct fraction on the first receiver.
fn first_share(light: u32) -> f32 {
  var total = 0.0;
  for (var i = 0u; i < step.n_columns - 2u; i++) { total += irradiance(0u, i); }
  if total == 0.0 { return 0.0; }
  return PRIOR_DIRECT_FRACTION * irradiance(0u, light) / total;
}

// Prior of a receiver's unknowns: common values for the first one; for the others the same lights, with the same share
// of ambient light.
fn receiver_prior(column: u32, channel: u32) -> f32 {
  if column == 0u { return 1.0; }
  if column == 1u && step.receiver > 0u { return solution.receivers[0].bounce[channel]; }
  if column == 1u { return select(PRIOR_BOUNCE, MAX_BOUNCE, has_no_light()); }
  if step.receiver == 0u { return first_share(column - 2u); }
  var total = 1.0;
  for (var i = 0u; i < step.n_columns - 2u; i++) {
    total += solution.receivers[0].direct_fraction[i][channel] * (of_first(i) - 1.0);
  }
  // A light behind the first receiver has no fraction there.
  if irradiance(0u, column - 2u) == 0.0 {
    return select(0.0, PRIOR_DIRECT_FRACTION / f32(step.n_columns - 2u), irradiance(step.receiver, column - 2u) > 0.0);
  }
  return solution.receivers[0].direct_fraction[column - 2u][channel] * of_first(column - 2u) / total;
}

fn load_equations(first_channel: u32, n_channels: u32) {
  for (var i = 0u; i < N_COLUMNS; i++) {
    unknowns[i] = 0.0;
    for (var j = 0u; j < N_COLUMNS; j++) { matrix[i * N_COLUMNS + j] = 0.0; }
  }
  for (var channel = first_channel; channel < first_channel + n_channels; channel++) {
    var k = channel * N_SUMS;
    for (var i = 0u; i < N_COLUMNS; i++) {
      unknowns[i] += sums[channel * N_SUMS + RIGHT_SUM + i];
      for (var j = i; j < N_COLUMNS; j++) {
        matrix[i * N_COLUMNS + j] += sums[k];
        if j > i { matrix[j * N_COLUMNS + i] += sums[k]; }
        k++;
      }
    }
  }
}

fn add_prior(column: u32, weight: f32, value: f32) {
  matrix[column * N_COLUMNS + column] += weight;
  unknowns[column] += weight * value;
}

// Gauss-Jordan without pivoting: the matrix is symmetric positive definite by its priors.
fn solve() {
  for (var p = 0u; p < step.n_columns; p++) {
    let pivot = matrix[p * N_COLUMNS + p];
    for (var i = 0u; i < step.n_columns; i++) {
      if i == p { continue; }
      let factor = matrix[i * N_COLUMNS + p] / pivot;
      for (var j = p; j < step.n_columns; j++) {
        matrix[i * N_COLUMNS + j] -= factor * matrix[p * N_COLUMNS + j];
      }
      unknowns[i] -= factor * unknowns[p];
    }
  }
  for (var p = 0u; p < step.n_columns; p++) { unknowns[p] /= matrix[p * N_COLUMNS + p]; }
}

fn store_receiver(channel: u32, clipped: f32) {
  let correction = unknowns[0];
  if step.receiver == 0u { solution.gain[channel] *= correction; }
  solution.receivers[step.receiver].bounce[channel] = clamp(unknowns[1] / correction, 0.0, MAX_BOUNCE);
  var total = 0.0;
  for (var i = 2u; i < step.n_columns; i++) {
    unknowns[i] = max(unknowns[i] / correction, 0.0);
    total += unknowns[i];
  }
  let scale = min(1.0, MAX_DIRECT_FRACTION / max(total, MAX_DIRECT_FRACTION));
  for (var i = 2u; i < step.n_columns; i++) {
    solution.receivers[step.receiver].direct_fraction[i - 2u][channel] = scale * unknowns[i];
  }
  solution.receivers[step.receiver].clipped[channel] = clipped;
}

fn solve_receiver(channel: u32) {
  load_equations(channel, 1u);
  let energy = matrix[0];
  for (var i = 0u; i < step.n_columns; i++) { add_prior(i, PRIOR_WEIGHT * energy, receiver_prior(i, channel)); }
  if step.receiver > 0u { add_prior(0u, SAME_GAIN_WEIGHT * energy, 1.0); }
  solve();
  if unknowns[0] > 0.0 { store_receiver(channel, sums[channel * N_SUMS + CLIPPED_SUM] / energy); }
}

// If no valid pixel shows the receiver, it gets the prior.
fn assume_receiver(channel: u32) {
  for (var i = 0u; i < step.n_columns; i++) { unknowns[i] = receiver_prior(i, channel); }
  store_receiver(channel, 0.0);
}

fn solve_intensities(channel: u32) {
  load_equations(channel, 1u);
  let weight = INTENSITY_WEIGHT * matrix[0];
  let gain = solution.gain[channel];
  add_prior(0u, weight, gain);
  add_prior(1u, weight, 0.0);
  for (var i = 2u; i < step.n_columns; i++) { add_prior(i, weight, gain * solution.intensity[i - 2u][channel]); }
  solve();
  if unknowns[0] <= 0.0 { return; }
  solution.gain[channel] = unknowns[0];
  for (var i = 2u; i < step.n_columns; i++) {
    solution.intensity[i - 2u][channel] = max(unknowns[i] / unknowns[0], 0.0);
  }
}

// Adds the equation that the sum of coefficients times unknowns is 0.
fn add_relation(weight: f32, coefficients: array<f32, N_COLUMNS>) {
  var c = coefficients;
  for (var i = 0u; i < N_COLUMNS; i++) {
    for (var j = 0u; j < N_COLUMNS; j++) { matrix[i * N_COLUMNS + j] += weight * c[i] * c[j]; }
  }
}

// Adds the receivers' constraint on the light on the toy; the mean of `channels` is used.
fn add_receiver_light(weight: f32, channels: vec3f) {
  let n_lights = step.n_columns - 2u;
  for (var i = 0u; i < n_lights; i++) {
    add_relation(weight * relation_weight(i, n_lights, channels), light_relation(i, n_lights, channels));
  }
  add_relation(weight, reflection_relation(n_lights));
}

// Removes the unknown `column` from the equations: it is 0.
fn take_out(column: u32) {
  for (var i = 0u; i < N_COLUMNS; i++) {
    matrix[i * N_COLUMNS + column] = 0.0;
    matrix[column * N_COLUMNS + i] = 0.0;
  }
  matrix[column * N_COLUMNS + column] = 1.0;
  unknowns[column] = 0.0;
}

// Solves the loaded equations without negative unknowns.
fn solve_non_negative() {
  whole = matrix;
  right = unknowns;
  var out: array<bool, N_COLUMNS>;
  for (var n_out = 0u; n_out < step.n_columns; n_out++) {
    matrix = whole;
    unknowns = right;
    for (var i = 0u; i < step.n_columns; i++) {
      if out[i] { take_out(i); }
    }
    solve();
    var lowest = 0u;
    for (var i = 1u; i < step.n_columns; i++) {
      if unknowns[i] < unknowns[lowest] { lowest = i; }
    }
    if unknowns[lowest] >= 0.0 { return; }
    out[lowest] = true;
    unknowns[lowest] = 0.0;
  }
}

// A channel in which the toy is dark follows the others: light is nearly white, and base colours are not.
fn solve_toy(channel: u32) {
  load_equations(0u, 3u);
  let energy = matrix[0] + matrix[N_COLUMNS + 1u];
  for (var i = 0u; i < step.n_columns; i++) { add_prior(i, PRIOR_WEIGHT * energy, 0.0); }
  add_receiver_light(RECEIVER_LIGHT_WEIGHT * energy, vec3f(1.0 / 3.0));
  solve_non_negative();
  let white = unknowns;
  load_equations(channel, 1u);
  for (var i = 0u; i < step.n_columns; i++) { add_prior(i, WHITE_WEIGHT * energy, white[i]); }
  var only = vec3f(0.0);
  only[channel] = 1.0;
  add_receiver_light(RECEIVER_LIGHT_WEIGHT * energy, only);
  solve_non_negative();
  for (var i = 0u; i < step.n_columns; i++) { solution.toy[i][channel] = unknowns[i]; }
}

// Without a valid pixel the start values stay; receivers after the first get their prior.
fn solve_channel(channel: u32, energy: f32, is_shadow_known: bool) {
  if step.subject == SUBJECT_INTENSITIES { solution.gain[channel] *= step.exposure_ratio; }
  if step.subject == SUBJECT_TOY {
    if energy > 0.0 { solve_toy(channel); }
  } else if sums[channel * N_SUMS] > 0.0 {
    if step.subject == SUBJECT_INTENSITIES {
      solve_intensities(channel);
    } else if has_no_light() && !is_shadow_known {
      solve_unshadowed(channel);
    } else {
      solve_receiver(channel);
    }
  } else if step.subject == SUBJECT_RECEIVER && step.receiver > 0u {
    assume_receiver(channel);
  }
}

fn total_sum(lane: u32) -> f32 {
  var total = 0.0;
  for (var row = 0u; row < step.n_rows; row++) { total += rows[row * N_ROW + lane]; }
  return total;
}

@compute @workgroup_size(96)
fn cs_solve(@builtin(local_invocation_index) lane: u32) {
  var fresh = 0.0;
  let slot = N_ROW * select(step.receiver, MAX_RECEIVERS, step.subject == SUBJECT_TOY) + lane;
  let is_accumulated = step.subject != SUBJECT_INTENSITIES;
  if lane < N_ROW {
    fresh = total_sum(lane);
    sums[lane] = fresh;
  }
  workgroupBarrier();
  let fresh_energy = sums[0] + sums[N_SUMS] + sums[2u * N_SUMS];
  workgroupBarrier();
  if lane < N_ROW && is_accumulated { sums[lane] = fresh + accumulated[slot]; }
  workgroupBarrier();
  let energy = sums[0] + sums[N_SUMS] + sums[2u * N_SUMS];
  if lane < N_ROW && is_accumulated && step.is_last == 1u && fresh_energy > 0.0 {
    accumulated[slot] = sums[lane] * min(1.0, MAX_FRAMES * fresh_energy / energy);
  }
  // One invocation processes all channels: a store to one component of a vector in memory may touch the others.
  if lane > 0u { return; }
  // This is decided in the last step: until then the weights follow the shadow.
  let is_shadow_known = !has_no_light() || step.is_last == 0u || is_ambient_shadow_known();
  for (var channel = 0u; channel < 3u; channel++) { solve_channel(channel, energy, is_shadow_known); }
}
