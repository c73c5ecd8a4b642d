//! Draws that share a target: a rectangle to each, where no other draws.

use crate::geometry::rect::PixelRect;
use crate::gpu::recorder::{Render, n_pixels};

/// Pixels of rectangles that have none in common.
pub(crate) fn n_pixels_of(parts: &[PixelRect]) -> u64 {
    parts.iter().map(|part| n_pixels(part.size_px)).sum()
}

/// Fills rectangles by the fullscreen pipeline that is set.
pub(crate) fn fill(render: &mut Render<'_>, parts: &[PixelRect]) {
    for part in parts {
        render.clip((part.origin_px, part.size_px));
        render.draw(0..3, 0..1);
    }
}
