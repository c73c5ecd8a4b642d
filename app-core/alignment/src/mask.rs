//! Pixels of a picture that are marked.

use glam::IVec2;

use super::rectangle::{index_in, places};

/// Marked pixels, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Mask {
    size_px: IVec2,
    pixels: Vec<bool>,
}

impl Mask {
    /// Of a picture of a size, with no mark.
    pub(super) fn new(size_px: IVec2) -> Self {
        Self {
            size_px,
            pixels: vec![false; (size_px.x * size_px.y) as usize],
        }
    }

    /// Whether a pixel is marked; none is outside the picture.
    pub(super) fn has(&self, at: IVec2) -> bool {
        index_in(self.size_px, at).is_some_and(|index| self.pixels[index])
    }

    /// Marks a pixel; none outside the picture.
    pub(super) fn mark(&mut self, at: IVec2) {
        if let Some(index) = index_in(self.size_px, at) {
            self.pixels[index] = true;
        }
    }

    /// With all pixels within a square around each that is marked.
    pub(super) fn grown(&self, reach_px: i32) -> Self {
        self.grown_along(IVec2::X, reach_px)
            .grown_along(IVec2::Y, reach_px)
    }

    fn grown_along(&self, axis: IVec2, reach_px: i32) -> Self {
        let mut grown = self.clone();
        for at in places(self.size_px).filter(|at| self.has(*at)) {
            // What lies between two that are marked is so already.
            let before = if self.has(at - axis) { 0 } else { reach_px };
            let behind = if self.has(at + axis) { 0 } else { reach_px };
            for step in -before..=behind {
                grown.mark(at + step * axis);
            }
        }
        grown
    }
}
