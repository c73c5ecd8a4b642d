// Tints of the real toy's paint: photograph over base colour times fitted light, in the cells of coarse grids around
// the physical toy, one grid per material.

struct TintGrid {
  // Lowest corner of the grids, which are cubes.
  corner_in_anchor: vec3f,
  cell_m: f32,
  n_materials: u32,
  _pad_0: u32,
  _pad_1: vec2u,
}

// The grid of a material; materials beyond the last share it.
fn tint_grid_of(material: u32) -> u32 {
  return min(material, tint_grid.n_materials - 1u);
}

// Position in cells of the finest level, with the centre of the first at (.5, .5, .5).
fn tint_place(in_anchor: vec3f) -> vec3f {
  return (in_anchor - tint_grid.corner_in_anchor) / tint_grid.cell_m;
}
