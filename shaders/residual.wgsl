// What the model leaves unexplained, pooled on a coarse grid: reflected colour, a faint second light, uneven ambient.
//
// r = sum w plate (frame - plate M) / sum w plate^2, never a division by one dark pixel.
//
// Reads: frame, plate, evidence, visibility, ambient. Writes: cells of (r, 1) times their certainty.
// Twin: reference/residual.rs.

@group(1) @binding(0) var<uniform> grid: Grid;
@group(1) @binding(1) var<storage, read_write> cells: array<vec4f>;
@group(1) @binding(2) var frame: texture_2d<f32>;
@group(1) @binding(3) var plate: texture_2d<f32>;
@group(1) @binding(4) var evidence: texture_2d<f32>;
@group(1) @binding(5) var visibility: texture_2d<f32>;
@group(1) @binding(6) var ambient: texture_2d<f32>;
@group(1) @binding(7) var ambient_sampler: sampler;

// A residual this large, in plates, is something the model does not know, such as a hand: it counts half.
const CAUCHY_SCALE: f32 = 0.03;
// Share of a cell's pixels that must be evidence for the cell to count in full.
const FULL_SHARE: f32 = 0.25;

@compute @workgroup_size(8, 8)
fn cs_pool(@builtin(global_invocation_id) cell: vec3u) {
  if any(cell.xy >= grid.size) { return; }
  let first = cell.xy * grid.cell_px;
  let last = min(first + grid.cell_px, vec2u(globals.region_size_px));
  var product = vec3f(0.0);
  var energy = vec3f(0.0);
  var weight_sum = 0.0;
  for (var y = first.y; y < last.y; y++) {
    for (var x = first.x; x < last.x; x++) {
      let texel = vec2u(x, y);
      let seen = textureLoad(evidence, texel, 0).r;
      let at = vec2f(texel) + 0.5;
      let point = receiver_point(at);
      if seen == 0.0 || !point.is_hit { continue; }
      let image_texel = texel + vec2u(globals.region_origin_px);
      let f = textureLoad(frame, image_texel, 0).rgb;
      let b = textureLoad(plate, image_texel, 0).rgb;
      let a = textureSampleLevel(ambient, ambient_sampler, at / globals.region_size_px, 0.0).r;
      let v = textureLoad(visibility, texel, 0);
      let e = f - b * receiver_model(point.in_plane, a, v);
      let brightness = dot(b, b);
      if brightness == 0.0 { continue; }
      let usable = is_evidence(f, b);
      let relative = dot(e, e) / (brightness * CAUCHY_SCALE * CAUCHY_SCALE);
      let weight = usable * (seen / (1.0 + relative));
      product += weight * b * e;
      energy += weight * b * b;
      weight_sum += dot(weight, vec3f(1.0 / 3.0));
    }
  }
  let n_pixels = f32(grid.cell_px * grid.cell_px);
  let certainty = min(1.0, weight_sum / (FULL_SHARE * n_pixels));
  let r = select(vec3f(0.0), product / energy, energy > vec3f(0.0));
  cells[cell.y * grid.size.x + cell.x] = vec4f(r, 1.0) * certainty;
}
