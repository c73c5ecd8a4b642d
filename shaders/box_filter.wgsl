// Box filter of the shadow term of one set of lights along one axis; samples outside that set's shadow are discarded.
//
// Sums and counts are separable though their ratio is not, so two passes, rows then columns, make the exact square box.
// Reads: terms with their set; then sums of rows. Writes: their sums, alpha the count.
// Twin: reference/box_filter.rs. Source: Casas et al. 2018, sections 3.3 and 3.5.

@group(1) @binding(0) var terms: texture_2d<f32>;

// The set whose rows are summed; 0 sums columns of what is summed already.
override SET: u32 = 0u;

@fragment
fn fs_sum(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let last = vec2i(textureDimensions(terms)) - 1;
  let axis = select(vec2i(1, 0), vec2i(0, 1), SET == 0u);
  var sum = vec4f(0.0);
  for (var k = -published.box_radius_px; k <= published.box_radius_px; k++) {
    let tap = texel + k * axis;
    if any(tap < vec2i(0)) || any(tap > last) { continue; }
    let term = textureLoad(terms, tap, 0);
    if SET == 0u { sum += term; }
    else if term.a == f32(SET) { sum += vec4f(term.rgb, 1.0); }
  }
  return sum;
}
