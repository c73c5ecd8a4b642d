// Sums of the weighted normal equations, for the receiver or for the toy.
//
// Receiver: frame = plate gain (A + bounce (1 - A) + sum_i share_i falloff_i (V_i - A) / plate_falloff)
// is linear in (gain, gain bounce, gain share_i), with plate_falloff taken from the step before.
// Toy: frame = base (toy_0 + toy_1 n.y + sum_i toy_i max(n.l_i, 0) V_i), V_i with the toy's shadow on itself.
// Nothing is divided by plate or base, so dark texels weigh little by themselves. Weights are Cauchy's, from the step
// before. Sums run over pixels here and over workgroups in `fit_solve`.
//
// Reads: frame, plate, evidence, visibility, ambient, object. Writes: rows of 27 sums, one a workgroup and channel.
// Twin: reference/fit.rs. Source: Holland and Welsch 1977 (iteratively reweighted least squares).

@group(1) @binding(0) var<uniform> step: FitStep;
@group(1) @binding(1) var<storage, read_write> rows: array<f32>;
@group(1) @binding(2) var frame: texture_2d<f32>;
@group(1) @binding(3) var plate: texture_2d<f32>;
@group(1) @binding(4) var evidence: texture_2d<f32>;
@group(1) @binding(5) var visibility: texture_2d<f32>;
@group(1) @binding(6) var ambient: texture_2d<f32>;
@group(1) @binding(7) var ambient_sampler: sampler;
@group(1) @binding(8) var object_base: texture_2d<f32>;
@group(1) @binding(9) var object_normal: texture_2d<f32>;
// Each light's cosine times its visibility.
@group(1) @binding(10) var object_received: texture_2d<f32>;

const WORKGROUP: u32 = 256u;
// Upper triangle of the symmetric matrix row by row, then the right-hand side.
const N_SUMS: u32 = 27u;
// Sums are reduced in three parts to stay within 16 KiB of workgroup memory.
const N_PART: u32 = 9u;
const N_PARTIAL: u32 = 2304u; // WORKGROUP * N_PART
// Residual, as a fraction of plate or base, at which a pixel counts half.
const CAUCHY_SCALE: f32 = 0.03;
// As above for the toy, of whose light from itself and curved faces the model does not know.
const TOY_CAUCHY_SCALE: f32 = 0.12;

var<workgroup> partial: array<f32, N_PARTIAL>;

struct Equation {
  columns: array<f32, N_COLUMNS>,
  value: f32,
  weight: f32,
}

fn cauchy_weight(residual: f32, scale: f32) -> f32 {
  if scale == 0.0 { return 0.0; }
  let r = residual / scale;
  return 1.0 / (1.0 + r * r);
}

fn frame_at(texel: vec2u) -> vec3f {
  return textureLoad(frame, texel + vec2u(globals.region_origin_px), 0).rgb;
}

fn receiver_equation(texel: vec2u, channel: u32) -> Equation {
  var eq: Equation;
  let at = vec2f(texel) + 0.5;
  let point = receiver_point(at);
  let seen = textureLoad(evidence, texel, 0).r;
  if seen == 0.0 || !point.is_hit { return eq; }
  let f = frame_at(texel);
  let b = textureLoad(plate, texel + vec2u(globals.region_origin_px), 0).rgb;
  let a = textureSampleLevel(ambient, ambient_sampler, at / globals.region_size_px, 0.0).r;
  let v = textureLoad(visibility, texel, 0);
  let total = plate_falloff(point.in_plane)[channel];
  eq.value = f[channel];
  eq.columns[0] = b[channel] * a;
  eq.columns[1] = b[channel] * (1.0 - a);
  var predicted = fit.gain[channel] * (eq.columns[0] + fit.bounce[channel] * eq.columns[1]);
  for (var i = 0u; i < globals.n_lights; i++) {
    let column = b[channel] * falloff(i, point.in_plane) * (v[i] - a) / total;
    eq.columns[2u + i] = column;
    predicted += fit.gain[channel] * fit.share[i][channel] * column;
  }
  eq.weight = seen * is_evidence(f, b)[channel];
  if step.is_reweighted == 1u { eq.weight *= cauchy_weight(eq.value - predicted, CAUCHY_SCALE * b[channel]); }
  return eq;
}

fn toy_equation(texel: vec2u, channel: u32) -> Equation {
  var eq: Equation;
  let base = textureLoad(object_base, texel, 0).rgb;
  let f = frame_at(texel);
  if textureLoad(evidence, texel, 0).g == 0.0 { return eq; }
  let normal = textureLoad(object_normal, texel, 0).xyz;
  eq.value = f[channel];
  let received = textureLoad(object_received, texel, 0);
  eq.columns[0] = base[channel];
  eq.columns[1] = base[channel] * normal.y;
  for (var i = 0u; i < globals.n_lights; i++) { eq.columns[2u + i] = base[channel] * received[i]; }
  let predicted = base[channel] * toy_radiance_over_base(normal, received)[channel];
  eq.weight = is_evidence(f, f)[channel];
  if step.is_reweighted == 1u { eq.weight *= cauchy_weight(eq.value - predicted, TOY_CAUCHY_SCALE * base[channel]); }
  return eq;
}

@compute @workgroup_size(WORKGROUP)
fn cs_accumulate(
  @builtin(workgroup_id) group: vec3u,
  @builtin(local_invocation_index) lane: u32,
) {
  let size = vec2u(globals.region_size_px) / step.stride_px;
  let channel = group.z;
  var sums: array<f32, N_SUMS>;
  for (var index = group.x * WORKGROUP + lane; index < size.x * size.y; index += step.n_rows * WORKGROUP) {
    let texel = vec2u(index % size.x, index / size.x) * step.stride_px;
    var eq: Equation;
    if step.subject == SUBJECT_RECEIVER { eq = receiver_equation(texel, channel); } else { eq = toy_equation(texel, channel); }
    if eq.weight == 0.0 { continue; }
    var k = 0u;
    for (var i = 0u; i < N_COLUMNS; i++) {
      for (var j = i; j < N_COLUMNS; j++) {
        sums[k] += eq.weight * eq.columns[i] * eq.columns[j];
        k++;
      }
      sums[21u + i] += eq.weight * eq.columns[i] * eq.value;
    }
  }
  let row = (group.x * 3u + channel) * N_SUMS;
  for (var part = 0u; part < N_SUMS; part += N_PART) {
    for (var k = 0u; k < N_PART; k++) { partial[k * WORKGROUP + lane] = sums[part + k]; }
    workgroupBarrier();
    for (var half = WORKGROUP / 2u; half > 0u; half /= 2u) {
      if lane < half {
        for (var k = 0u; k < N_PART; k++) {
          partial[k * WORKGROUP + lane] += partial[k * WORKGROUP + lane + half];
        }
      }
      workgroupBarrier();
    }
    if lane < N_PART { rows[row + part + lane] = partial[lane * WORKGROUP]; }
    workgroupBarrier();
  }
}
