// The value of a coarse grid between its cells.

fn cell_at(point: ReceiverPoint) -> vec4f {
  let grid = grids.grids[point.receiver];
  if grid.cell_m == 0.0 { return vec4f(0.0); }
  let at = (point.in_plane - grid.origin_in_plane) / grid.cell_m - 0.5;
  let low = floor(at);
  let t = at - low;
  var sum = vec4f(0.0);
  for (var k = 0u; k < 4u; k++) {
    let corner = vec2f(f32(k & 1u), f32(k >> 1u));
    let cell = vec2u(clamp(low + corner, vec2f(0.0), vec2f(grid.size) - 1.0));
    let weight = mix(1.0 - t.x, t.x, corner.x) * mix(1.0 - t.y, t.y, corner.y);
    sum += weight * cells[grid.first_cell + cell.y * grid.size.x + cell.x];
  }
  return sum;
}
