// Sums of weighted normal equations: over the pixels of an invocation, then over its workgroup,
// into `rows` of the shader.

//#import common/fit
//#import common/fit_row

const WORKGROUP: u32 = 256u;
// Sums are reduced in four parts to stay within 16 KiB of workgroup memory.
const N_PART: u32 = 7u;
const N_PARTIAL: u32 = 1792u; // WORKGROUP * N_PART
const N_STRIDED: u32 = 16u;
const N_ALL_STRIDED: u32 = 112u; // N_PART * N_STRIDED

var<workgroup> partial: array<f32, N_PARTIAL>;
var<workgroup> strided: array<f32, N_ALL_STRIDED>;
// Sums of the invocation's pixels.
var<private> sums: array<vec3f, N_SUMS>;

// Values for each channel.
struct Equation {
  columns: array<vec3f, N_COLUMNS>,
  value: vec3f,
  weight: vec3f,
  // 1 if frame and plate may both be clipped.
  clipped: vec3f,
}

// Adds a pixel's equation to the invocation's sums. It has no loops, since processors keep
// dynamically indexed sums in memory.
fn add(eq: Equation) {
  if all(eq.weight == vec3f(0.0)) { return; }
  let w0 = eq.weight * eq.columns[0];
  let w1 = eq.weight * eq.columns[1];
  let w2 = eq.weight * eq.columns[2];
  let w3 = eq.weight * eq.columns[3];
  let w4 = eq.weight * eq.columns[4];
  let w5 = eq.weight * eq.columns[5];
  sums[0] += w0 * eq.columns[0];
  sums[1] += w0 * eq.columns[1];
  sums[2] += w0 * eq.columns[2];
  sums[3] += w0 * eq.columns[3];
  sums[4] += w0 * eq.columns[4];
  sums[5] += w0 * eq.columns[5];
  sums[6] += w1 * eq.columns[1];
  sums[7] += w1 * eq.columns[2];
  sums[8] += w1 * eq.columns[3];
  sums[9] += w1 * eq.columns[4];
  sums[10] += w1 * eq.columns[5];
  sums[11] += w2 * eq.columns[2];
  sums[12] += w2 * eq.columns[3];
  sums[13] += w2 * eq.columns[4];
  sums[14] += w2 * eq.columns[5];
  sums[15] += w3 * eq.columns[3];
  sums[16] += w3 * eq.columns[4];
  sums[17] += w3 * eq.columns[5];
  sums[18] += w4 * eq.columns[4];
  sums[19] += w4 * eq.columns[5];
  sums[20] += w5 * eq.columns[5];
  sums[21] += w0 * eq.value;
  sums[22] += w1 * eq.value;
  sums[23] += w2 * eq.value;
  sums[24] += w3 * eq.value;
  sums[25] += w4 * eq.value;
  sums[26] += w5 * eq.value;
  sums[CLIPPED_SUM] += eq.clipped * w0 * eq.columns[0];
}

// Adds up a workgroup's sums into its rows, one per channel: first with a stride, then the rest,
// since barriers cost more than additions.
fn reduce(group: u32, lane: u32) {
  let first = lane / N_STRIDED * WORKGROUP + lane % N_STRIDED;
  for (var channel = 0u; channel < 3u; channel++) {
    let row = (group * 3u + channel) * N_SUMS;
    for (var part = 0u; part < N_SUMS; part += N_PART) {
      for (var k = 0u; k < N_PART; k++) { partial[k * WORKGROUP + lane] = sums[part + k][channel]; }
      workgroupBarrier();
      if lane < N_PART * N_STRIDED {
        var sum = 0.0;
        for (var j = 0u; j < WORKGROUP; j += N_STRIDED) { sum += partial[first + j]; }
        strided[lane] = sum;
      }
      workgroupBarrier();
      if lane < N_PART {
        var sum = 0.0;
        for (var j = 0u; j < N_STRIDED; j++) { sum += strided[lane * N_STRIDED + j]; }
        rows[row + part + lane] = sum;
      }
    }
  }
}
