// Bilinear interpolation between cells of one level; `at` is in cells, the centre of the first at (0, 0).

fn between_cells(first: u32, size: vec2u, at: vec2f) -> vec4f {
  let low = floor(at);
  let t = at - low;
  var sum = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let corner = vec2f(f32(k & 1u), f32(k >> 1u));
    let cell = vec2u(clamp(low + corner, vec2f(0.0), vec2f(size) - 1.0));
    let weight = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
    sum += weight * cells[first + cell.y * size.x + cell.x];
  }
  return sum;
}
