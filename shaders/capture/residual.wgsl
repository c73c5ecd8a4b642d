// Residual of the model, pooled on coarse grids: reflected colour, a faint second light, uneven ambient.
//
// r = sum w plate (frame / gain - reflected - plate M) / sum w plate^2, never a division by one dark pixel.
//
// Reads: frame, plate, validity, visibility, ambient. Writes: cells of (r, 1) times their certainty, finest levels of
// the pyramids. CPU reference: tests/reference/src/residual.rs.

//#import common/fit
//#import common/frame
//#import common/model
//#import common/pixel
//#import common/reflection
//#import common/pool
//#import common/marks

@group(1) @binding(4) var plate: texture_2d<f32>;
@group(1) @binding(5) var validity: texture_2d<f32>;
@group(1) @binding(6) var visibility: texture_2d<f32>;
@group(1) @binding(7) var ambient: texture_2d<f32>;
@group(1) @binding(8) var ambient_sampler: sampler;

// Residual, in plates, at which a point's weight is one half: an outlier, such as a hand.
const CAUCHY_SCALE: f32 = 0.03;

struct Sums {
  product: vec3f,
  energy: vec3f,
  // Number of points, weighted by their evidence, including outliers such as a hand.
  n_points: f32,
}

fn add_point(sums: Sums, point: ReceiverPoint) -> Sums {
  let at = region_px_of(point);
  if any(at < vec2f(0.0)) || any(at >= globals.region_size_px) { return sums; }
  let texel = vec2u(at);
  let seen = marks_at(vec2i(texel)).r;
  if seen == 0.0 || receiver_of(receiver_point(vec2f(texel) + 0.5)) != receiver_of(point) { return sums; }
  let f = frame_at(vec2i(texel));
  let b = textureLoad(plate, texel, 0);
  let brightness = dot(b.rgb, b.rgb);
  // An estimated plate was made from this frame itself.
  if brightness == 0.0 || b.a < 1.0 { return sums; }
  let a = textureSampleLevel(ambient, ambient_sampler, (vec2f(texel) + 0.5) / globals.region_size_px, 0.0).r;
  let v = textureLoad(visibility, texel, 0);
  // The visibilities were sampled at the pixel's centre.
  let here = receiver_point(vec2f(texel) + 0.5);
  let e = f / fit.gain.rgb - reflected(here, v) - b.rgb * receiver_model(here, a, v);
  let relative = dot(e, e) / (brightness * CAUCHY_SCALE * CAUCHY_SCALE);
  let evidence = seen * evidence_of(f, b.rgb);
  let weight = evidence / (1.0 + relative);
  return Sums(
    sums.product + weight * b.rgb * e,
    sums.energy + weight * b.rgb * b.rgb,
    sums.n_points + dot(evidence, vec3f(1.0 / 3.0)),
  );
}

@compute @workgroup_size(8, 8)
fn cs_pool(@builtin(global_invocation_id) cell: vec3u) {
  if !is_cell(cell.z, cell.xy) { return; }
  var sums = Sums(vec3f(0.0), vec3f(0.0), 0.0);
  for (var k = 0u; k < n_taken(); k++) { sums = add_point(sums, point_of_cell(cell.z, cell.xy, k)); }
  let r = select(vec3f(0.0), sums.product / sums.energy, sums.energy > vec3f(0.0));
  accumulate(cell.z, cell.xy, r, sums.n_points);
}
