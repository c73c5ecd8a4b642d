// The coarse grid of residuals over the region.

struct Grid {
  // Cells of the finest level, at most 64 x 64.
  size: vec2u,
  cell_px: u32,
  _pad: u32,
}
