// What the model leaves unexplained, pooled on coarse grids: reflected colour, a faint second light, uneven ambient.
//
// r = sum w plate (frame / gain - plate M) / sum w plate^2, never a division by one dark pixel.
// A cell takes a fixed set of points of its receiver, whichever pixels show them, so that it does not swim when the
// camera moves, and adds to what it knew.
//
// Reads: frame, plate, evidence, visibility, ambient. Writes: cells of (r, 1) times their certainty, finest levels of the
// pyramids. Twin: reference/residual.rs.

@group(1) @binding(1) var<storage, read_write> cells: array<vec4f>;
// What was known before: sums of r times certainty, and of certainties. Those of the finest levels alone.
@group(1) @binding(2) var<storage, read_write> kept: array<vec4f>;
@group(1) @binding(3) var frame: texture_2d<f32>;
@group(1) @binding(4) var plate: texture_2d<f32>;
@group(1) @binding(5) var evidence: texture_2d<f32>;
@group(1) @binding(6) var visibility: texture_2d<f32>;
@group(1) @binding(7) var ambient: texture_2d<f32>;
@group(1) @binding(8) var ambient_sampler: sampler;

// Points of a cell along each side.
const N_POINTS: u32 = 8u;
// A residual this large, in plates, is something the model does not know, such as a hand: it counts half.
const CAUCHY_SCALE: f32 = 0.03;
// Share of a cell's points that must be evidence for the cell to count in full.
const FULL_SHARE: f32 = 0.25;
// What was known before weighs at most as much as this many frames.
const MOST_KEPT: f32 = 8.0;

struct Sums {
  product: vec3f,
  energy: vec3f,
  // Points that are evidence, whether the model explains them or not: a hand is known to be there.
  n_points: f32,
}

fn add_point(sums: Sums, point: ReceiverPoint) -> Sums {
  let at = region_px_of(point);
  if any(at < vec2f(0.0)) || any(at >= globals.region_size_px) { return sums; }
  let texel = vec2u(at);
  let seen = textureLoad(evidence, texel, 0).r;
  if seen == 0.0 || receiver_point(vec2f(texel) + 0.5).receiver != point.receiver { return sums; }
  let f = textureLoad(frame, texel + vec2u(globals.region_origin_px), 0).rgb;
  let b = textureLoad(plate, texel, 0);
  let brightness = dot(b.rgb, b.rgb);
  // An estimated plate was made from this very frame.
  if brightness == 0.0 || b.a < 1.0 { return sums; }
  let a = textureSampleLevel(ambient, ambient_sampler, (vec2f(texel) + 0.5) / globals.region_size_px, 0.0).r;
  let v = textureLoad(visibility, texel, 0);
  // At the pixel's centre, where the visibilities are those of.
  let e = f / fit.gain.rgb - b.rgb * receiver_model(receiver_point(vec2f(texel) + 0.5), a, v);
  let relative = dot(e, e) / (brightness * CAUCHY_SCALE * CAUCHY_SCALE);
  let usable = seen * is_evidence(f, b.rgb);
  let weight = usable / (1.0 + relative);
  return Sums(
    sums.product + weight * b.rgb * e,
    sums.energy + weight * b.rgb * b.rgb,
    sums.n_points + dot(usable, vec3f(1.0 / 3.0)),
  );
}

@compute @workgroup_size(8, 8)
fn cs_pool(@builtin(global_invocation_id) cell: vec3u) {
  let receiver = cell.z;
  let grid = grids.grids[receiver];
  // Nothing reaches a receiver whose cells have no extent.
  if any(cell.xy >= grid.size) || grid.cell_m == 0.0 { return; }
  var sums = Sums(vec3f(0.0), vec3f(0.0), 0.0);
  for (var k = 0u; k < N_POINTS * N_POINTS; k++) {
    let within = (vec2f(f32(k % N_POINTS), f32(k / N_POINTS)) + 0.5) / f32(N_POINTS);
    let in_plane = grid.origin_in_plane + (vec2f(cell.xy) + within) * grid.cell_m;
    sums = add_point(sums, ReceiverPoint(receiver, in_plane));
  }
  let certainty = min(1.0, sums.n_points / (FULL_SHARE * f32(N_POINTS * N_POINTS)));
  let r = select(vec3f(0.0), sums.product / sums.energy, sums.energy > vec3f(0.0));
  let index = cell.y * grid.size.x + cell.x;
  let slot = receiver * MAX_CELLS + index;
  let known = kept[slot] + vec4f(r, 1.0) * certainty;
  kept[slot] = known * min(1.0, MOST_KEPT / max(known.a, MOST_KEPT));
  cells[grid.first_cell + index] = known / max(known.a, 1.0);
}
