// Solves the normal equations that `fit` summed, per channel, with weak priors that decide what the frame does not show.
//
// Reads: rows of sums. Writes: the solution.
// Twin: reference/fit.rs.

@group(1) @binding(0) var<uniform> step: FitStep;
@group(1) @binding(1) var<storage, read> rows: array<f32>;
@group(1) @binding(2) var<storage, read_write> solution: Fit;

const N_SUMS: u32 = 27u;
// Weight of the priors against the energy of the first column.
const PRIOR_WEIGHT: f32 = 1e-4;
// Weight of the three channels' common solution, for the toy, against their common energy.
const WHITE_WEIGHT: f32 = 0.003;
// A toy of middle grey throws back this fraction of the ambient light it takes away.
const PRIOR_BOUNCE: f32 = 0.2;
// All lights together, half of the plate's radiance.
const PRIOR_SHARE: f32 = 0.5;
// Shares sum to less than 1, since some light is always ambient: keeps plate_falloff positive.
const MAX_SHARE: f32 = 0.98;
const MAX_BOUNCE: f32 = 1.0;

var<workgroup> sums: array<f32, 81>;
var<private> matrix: array<f32, 36>;
var<private> unknowns: array<f32, N_COLUMNS>;

fn receiver_prior(column: u32) -> f32 {
  if column == 0u { return 1.0; }
  if column == 1u { return PRIOR_BOUNCE; }
  return PRIOR_SHARE / f32(step.n_columns - 2u);
}

fn load_equations(first_channel: u32, n_channels: u32) {
  for (var i = 0u; i < N_COLUMNS; i++) {
    unknowns[i] = 0.0;
    for (var j = 0u; j < N_COLUMNS; j++) { matrix[i * N_COLUMNS + j] = 0.0; }
  }
  for (var channel = first_channel; channel < first_channel + n_channels; channel++) {
    var k = channel * N_SUMS;
    for (var i = 0u; i < N_COLUMNS; i++) {
      unknowns[i] += sums[channel * N_SUMS + 21u + i];
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

fn store_receiver(channel: u32, contrast: f32) {
  let gain = unknowns[0];
  solution.gain[channel] = gain;
  solution.bounce[channel] = clamp(unknowns[1] / gain, 0.0, MAX_BOUNCE);
  var total = 0.0;
  for (var i = 2u; i < step.n_columns; i++) {
    unknowns[i] = max(unknowns[i] / gain, 0.0);
    total += unknowns[i];
  }
  let scale = min(1.0, MAX_SHARE / max(total, MAX_SHARE));
  for (var i = 2u; i < step.n_columns; i++) { solution.share[i - 2u][channel] = scale * unknowns[i]; }
  solution.contrast[channel] = contrast;
}

fn store_toy(channel: u32) {
  for (var i = 0u; i < step.n_columns; i++) { solution.toy[i][channel] = unknowns[i]; }
}

fn solve_receiver(channel: u32) {
  load_equations(channel, 1u);
  let energy = matrix[0];
  var light_energy = 0.0;
  for (var i = 2u; i < step.n_columns; i++) { light_energy += matrix[i * N_COLUMNS + i]; }
  for (var i = 0u; i < step.n_columns; i++) { add_prior(i, PRIOR_WEIGHT * energy, receiver_prior(i)); }
  solve();
  if unknowns[0] > 0.0 { store_receiver(channel, light_energy / energy); }
}

// A channel in which the toy is dark follows the others: light is nearly white, base colours are not.
fn solve_toy(channel: u32) {
  load_equations(0u, 3u);
  let energy = matrix[0];
  for (var i = 0u; i < step.n_columns; i++) { add_prior(i, PRIOR_WEIGHT * energy, 0.0); }
  solve();
  let white = unknowns;
  load_equations(channel, 1u);
  for (var i = 0u; i < step.n_columns; i++) { add_prior(i, WHITE_WEIGHT * energy, white[i]); }
  solve();
  store_toy(channel);
}

@compute @workgroup_size(96)
fn cs_solve(@builtin(local_invocation_index) lane: u32) {
  if lane < 81u {
    var total = 0.0;
    for (var row = 0u; row < step.n_rows; row++) { total += rows[row * 81u + lane]; }
    sums[lane] = total;
  }
  workgroupBarrier();
  if lane >= 3u { return; }
  // Without any evidence the starting values stay.
  if step.subject == SUBJECT_RECEIVER {
    if sums[lane * N_SUMS] > 0.0 { solve_receiver(lane); }
  } else if sums[0] + sums[N_SUMS] + sums[2u * N_SUMS] > 0.0 {
    solve_toy(lane);
  }
}
