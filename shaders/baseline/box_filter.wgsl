// Box filter of the shadow term of one label along one axis; samples outside that shadow are
// discarded.
//
// Sums and counts are separable although their ratio is not, so two passes, rows then columns, make
// the exact square box. Each texel keeps the sums of its own receiver: one receiver's columns do
// not change the others' texels.
// Reads: terms with their label; then sums of rows. Writes: their sums, with the count in alpha.
// CPU reference: tests/reference/src/box_filter.rs. Source: Casas et al. 2018, sections 3.3 and
// 3.5.

//#import common/baseline
//#import common/fullscreen

struct Summed {
  // The label whose rows are summed; 0 sums the columns of these sums, in texels of `receiver`.
  label: u32,
  receiver: u32,
}

@group(1) @binding(0) var<uniform> summed: Summed;
@group(1) @binding(1) var terms: texture_2d<f32>;

@fragment
fn fs_sum(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  if summed.label == 0u && receiver_at(texel) != summed.receiver { discard; }
  let last = vec2i(textureDimensions(terms)) - 1;
  let axis = select(vec2i(1, 0), vec2i(0, 1), summed.label == 0u);
  var sum = vec4f(0.0);
  for (var k = -baseline.box_radius_px; k <= baseline.box_radius_px; k++) {
    let tap = texel + k * axis;
    if any(tap < vec2i(0)) || any(tap > last) { continue; }
    let term = textureLoad(terms, tap, 0);
    if summed.label == 0u { sum += term; }
    else if term.a == f32(summed.label) { sum += vec4f(term.rgb, 1.0); }
  }
  return sum;
}
