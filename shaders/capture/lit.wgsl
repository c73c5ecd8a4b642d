// Colour of the lit receivers, pooled on coarse grids: the source of an estimated plate.
//
// B = (frame - gain reflected) / (gain M), its mean 0 at least, if the receiver is visible and most of its light remains.
// Reads: frame, validity, visibility, ambient. Writes: cells of (B, 1) times their certainty,
// finest levels.
// CPU reference: tests/reference/src/lit.rs.

//#import common/fit
//#import common/frame
//#import common/model
//#import common/channels
//#import common/pool
//#import common/reflection
//#import common/marks

@group(1) @binding(4) var validity: texture_2d<f32>;
@group(1) @binding(5) var visibility: texture_2d<f32>;
@group(1) @binding(6) var ambient: texture_2d<f32>;
@group(1) @binding(7) var ambient_sampler: sampler;

// Exponent of the remaining light: shadow counts little, since its depth may not be fitted yet.
const LIT_POWER: f32 = 8.0;

fn lit_color(point: ReceiverPoint) -> vec4f {
  let at = region_px_of(point);
  if any(at < vec2f(0.0)) || any(at >= globals.region_size_px) { return vec4f(0.0); }
  let texel = vec2u(at);
  let here = receiver_point(vec2f(texel) + 0.5);
  let seen = marks_at(vec2i(texel)).b;
  if seen == 0.0 || receiver_of(here) != receiver_of(point) { return vec4f(0.0); }
  let f = frame_at(vec2i(texel));
  let a = textureSampleLevel(ambient, ambient_sampler, (vec2f(texel) + 0.5) / globals.region_size_px, 0.0).r;
  let v = textureLoad(visibility, texel, 0);
  let model = receiver_model(here, a, v);
  let left = smallest(model);
  if left <= 0.0 { return vec4f(0.0); }
  return vec4f((f - fit.gain.rgb * reflected(here, v)) / (fit.gain.rgb * model), 1.0) * pow(min(left, 1.0), LIT_POWER);
}

@compute @workgroup_size(8, 8)
fn cs_pool(@builtin(global_invocation_id) cell: vec3u) {
  if !is_cell(cell.z, cell.xy) { return; }
  var sum = vec4f(0.0);
  for (var k = 0u; k < n_taken(); k++) { sum += lit_color(point_of_cell(cell.z, cell.xy, k)); }
  accumulate(cell.z, cell.xy, select(vec3f(0.0), max(sum.rgb / sum.a, vec3f(0.0)), sum.a > 0.0), sum.a);
}
