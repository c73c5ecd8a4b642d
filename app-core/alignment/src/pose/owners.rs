//! The nearest piece of the outline for each pixel beside it.

use glam::{DVec2, IVec2};

use super::contour::Element;
use crate::picture::{index_in, places};
use crate::raster::Coverage;

/// The nearest piece of the outline for each pixel of the band.
pub(super) struct Owners {
    origin_px: IVec2,
    size_px: IVec2,
    /// Index of the piece, with the distance squared.
    nearest: Vec<Option<(usize, f64)>>,
}

impl Owners {
    /// For a band of half the given width.
    pub(super) fn new(elements: &[Element], coverage: &Coverage, half_px: f64) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let margin_px = half_px.ceil() as i32 + 1;
        let size_px = coverage.size_px + 2 * margin_px;
        let mut owners = Self {
            origin_px: coverage.origin_px - margin_px,
            size_px,
            nearest: vec![None; (size_px.x * size_px.y) as usize],
        };
        for (index, element) in elements.iter().enumerate() {
            for y in -margin_px..=margin_px {
                for x in -margin_px..=margin_px {
                    let at = element.pixel(0.0) + IVec2::new(x, y);
                    owners.offer(at, index, element, half_px);
                }
            }
        }
        owners
    }

    fn offer(&mut self, at: IVec2, index: usize, element: &Element, half_px: f64) {
        let from = at.as_dvec2() + DVec2::splat(0.5) - element.at_px;
        let distance = from.length_squared();
        let is_in_band =
            from.dot(element.normal).abs() <= half_px + 0.5 && distance <= (half_px + 1.0).powi(2);
        let Some(index_of_pixel) = index_in(self.size_px, at - self.origin_px).filter(|_| is_in_band) else {
            return;
        };
        let nearest = &mut self.nearest[index_of_pixel];
        if nearest.is_none_or(|(_, other)| distance < other) {
            *nearest = Some((index, distance));
        }
    }

    /// Pixels with the index of their piece.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (IVec2, usize)> + '_ {
        let owned = places(self.size_px).zip(&self.nearest);
        owned.filter_map(|(place, nearest)| Some((self.origin_px + place, (*nearest)?.0)))
    }
}
