// Colour that a soft picture mixes into the toy's at its outline: that of the receiver beside it,
// in the real shadow.
//
//   frame = part of the toy x its own colour + (1 - part) x gain x this
// The part is counted over positions with the picture's spread of a point. In a sharp picture only
// pixels inside the outline are used, which are not mixed.
//
// Reads: plate, visibility, ambient, residual cells, depth of the physical toy. Writes: in the
// physical box, the mixed-in colour relative to the gain; alpha is the part of the pixel that shows
// the toy. CPU reference: tests/reference/src/rim.rs.
// Source: Chuang et al. 2001 (matting: colours are unmixed if the part is known).

//#import common/model
//#import common/cells
//#import common/position_steps
//#import common/spread
//#import common/reflection
//#import common/fullscreen

@group(1) @binding(1) var<storage, read> cells: array<vec4f>;
@group(1) @binding(2) var plate: texture_2d<f32>;
@group(1) @binding(3) var visibility: texture_2d<f32>;
@group(1) @binding(4) var ambient: texture_2d<f32>;
@group(1) @binding(5) var ambient_sampler: sampler;
@group(1) @binding(6) var gbuffer_depth: texture_depth_2d;

const N_POSITIONS: u32 = 64u;

// Part of a pixel of the physical box that shows the toy.
fn part_of_toy(at: vec2f) -> f32 {
  let size = vec2i(textureDimensions(gbuffer_depth));
  var n_toy = 0u;
  for (var k = 0u; k < N_POSITIONS; k++) {
    let lattice = (vec2f(k * POSITION_STEPS % N_POSITIONS) + 0.5) / f32(N_POSITIONS);
    let texel = vec2i(floor(at + spread_position_px(lattice) + beside_px(k)));
    let is_inside = all(texel >= vec2i(0)) && all(texel < size);
    let depth = textureLoad(gbuffer_depth, clamp(texel, vec2i(0), size - 1), 0);
    n_toy += select(0u, 1u, is_inside && depth > 0.0);
  }
  return f32(n_toy) / f32(N_POSITIONS);
}

// The receiver at a texel of the region, relative to the gain; 0 without a plate.
fn shown_receiver(texel: vec2i) -> vec4f {
  let at = vec2f(texel) + 0.5;
  let b = textureLoad(plate, texel, 0);
  if b.a == 0.0 { return vec4f(0.0); }
  let point = receiver_point(at);
  if !is_hit(point) { return vec4f(b.rgb, 1.0); }
  let a = textureSampleLevel(ambient, ambient_sampler, at / globals.region_size_px, 0.0).r;
  let v = textureLoad(visibility, texel, 0);
  let model = receiver_model(point, a, v);
  return vec4f(b.rgb * max(model + cell_at(point).rgb, vec3f(0.0)) + reflected(point, v), 1.0);
}

@fragment
fn fs_mix(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let part = part_of_toy(position.xy);
  if part == 0.0 || part == 1.0 { return vec4f(0.0, 0.0, 0.0, part); }
  let receiver = shown_receiver(region_texel(vec2i(position.xy)));
  // An unknown colour is not unmixed.
  return vec4f(receiver.rgb, select(1.0, part, receiver.a == 1.0));
}
