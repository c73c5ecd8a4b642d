// Box filter of the shadow term along one axis; samples outside the shadow are discarded.
//
// Sums and counts are separable though their ratio is not, so two passes, rows then columns, make the exact square box.
// Reads: terms times their weight. Writes: their sums, alpha the count.
// Twin: reference/box_filter.rs. Source: Casas et al. 2018, sections 3.3 and 3.5.

@group(1) @binding(0) var terms: texture_2d<f32>;

override IS_ROWS: bool = true;

@fragment
fn fs_sum(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let texel = vec2i(at.xy);
  let last = vec2i(textureDimensions(terms)) - 1;
  let axis = select(vec2i(0, 1), vec2i(1, 0), IS_ROWS);
  var sum = vec4f(0.0);
  for (var k = -published.box_radius_px; k <= published.box_radius_px; k++) {
    let tap = texel + k * axis;
    if any(tap < vec2i(0)) || any(tap > last) { continue; }
    sum += textureLoad(terms, tap, 0);
  }
  return sum;
}
