// Box filter of the shadow term of one label along one axis; samples outside that shadow are discarded.
//
// Sums and counts are separable though their ratio is not, so two passes, rows then columns, make the exact square box.
// Each texel keeps the sums of its own receiver: one receiver's columns leave the others' texels as they are.
// Reads: terms with their label; then sums of rows. Writes: their sums, alpha the count.
// Twin: reference/box_filter.rs. Source: Casas et al. 2018, sections 3.3 and 3.5.

@group(1) @binding(0) var terms: texture_2d<f32>;

// The label whose rows are summed; 0 sums columns, of texels of `RECEIVER`, of what is summed already.
override LABEL: u32 = 0u;
override RECEIVER: u32 = 0u;

@fragment
fn fs_sum(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  if LABEL == 0u && receiver_at(texel) != RECEIVER { discard; }
  let last = vec2i(textureDimensions(terms)) - 1;
  let axis = select(vec2i(1, 0), vec2i(0, 1), LABEL == 0u);
  var sum = vec4f(0.0);
  for (var k = -published.box_radius_px; k <= published.box_radius_px; k++) {
    let tap = texel + k * axis;
    if any(tap < vec2i(0)) || any(tap > last) { continue; }
    let term = textureLoad(terms, tap, 0);
    if LABEL == 0u { sum += term; }
    else if term.a == f32(LABEL) { sum += vec4f(term.rgb, 1.0); }
  }
  return sum;
}
