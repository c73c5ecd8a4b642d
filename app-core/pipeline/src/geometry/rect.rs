//! Rectangles of the camera image and of a receiver's plane.

use glam::{DVec2, UVec2};
use serde::Serialize;

/// A rectangle of the camera image, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PixelRect {
    /// Top left corner.
    pub origin_px: UVec2,
    /// Size; not zero.
    pub size_px: UVec2,
}

impl PixelRect {
    /// The rectangle grown by `margin_px` on each side, limited to the image.
    #[must_use]
    pub fn grown(&self, margin_px: u32, image_px: UVec2) -> Self {
        let origin_px = self.origin_px.saturating_sub(UVec2::splat(margin_px));
        let end_px = (self.origin_px + self.size_px + margin_px).min(image_px);
        Self {
            origin_px,
            size_px: end_px - origin_px,
        }
    }

    /// The intersection with `other`; `None` if it is empty.
    #[must_use]
    pub fn common(&self, other: &Self) -> Option<Self> {
        let origin_px = self.origin_px.max(other.origin_px);
        let end_px = (self.origin_px + self.size_px).min(other.origin_px + other.size_px);
        let size_px = end_px.saturating_sub(origin_px);
        (size_px.min_element() > 0).then_some(Self { origin_px, size_px })
    }

    /// The rectangle without `part`, in at most four rectangles.
    pub fn beside(&self, part: &Self) -> impl Iterator<Item = Self> {
        let (UVec2 { x: left, y: top }, end) = (self.origin_px, self.origin_px + self.size_px);
        let (from, to) = (part.origin_px, part.origin_px + part.size_px);
        let rects = [
            [left, top, end.x, from.y],
            [left, from.y, from.x, to.y],
            [to.x, from.y, end.x, to.y],
            [left, to.y, end.x, end.y],
        ];
        let rects = rects.into_iter().map(|[x, y, end_x, end_y]| Self {
            origin_px: UVec2::new(x, y),
            size_px: UVec2::new(end_x, end_y) - UVec2::new(x, y),
        });
        rects.filter(|rect| rect.size_px.min_element() > 0)
    }

    /// Whether the rectangle contains all of `other`.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        self.origin_px.cmple(other.origin_px).all()
            && (self.origin_px + self.size_px)
                .cmpge(other.origin_px + other.size_px)
                .all()
    }

    /// The rectangle of `size_px` within the image that contains this smaller one, centred on it as
    /// far as possible.
    #[must_use]
    pub fn within(&self, size_px: UVec2, image_px: UVec2) -> Self {
        let spare_px = size_px.saturating_sub(self.size_px) / 2;
        let last_px = image_px.saturating_sub(size_px);
        Self {
            origin_px: self.origin_px.saturating_sub(spare_px).min(last_px),
            size_px,
        }
    }
}

/// A rectangle of a receiver's plane, (x, z) in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneRect {
    /// Smallest coordinates.
    pub min: DVec2,
    /// Largest coordinates.
    pub max: DVec2,
}

impl PlaneRect {
    /// Whether the rectangle contains a point.
    #[must_use]
    pub fn holds(&self, in_plane: DVec2) -> bool {
        in_plane.cmpge(self.min).all() && in_plane.cmple(self.max).all()
    }

    /// The point of the rectangle nearest to a point.
    #[must_use]
    pub fn nearest(&self, in_plane: DVec2) -> DVec2 {
        in_plane.clamp(self.min, self.max)
    }

    /// The four corners.
    #[must_use]
    pub fn corners(&self) -> [DVec2; 4] {
        let Self { min, max } = *self;
        [max, min, DVec2::new(max.x, min.y), DVec2::new(min.x, max.y)]
    }
}
