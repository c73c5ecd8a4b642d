//! The part of a picture that a set of points covers.

use glam::{DVec2, DVec3, UVec2};

use crate::geometry::rect::PixelRect;

/// Depth of the near plane in metres: a small part of any scene, since reversed depth loses no
/// precision by it.
pub(crate) const NEAR_M: f64 = 1e-6;

/// An extent that grows point by point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    min_px: DVec2,
    max_px: DVec2,
    /// Whether a point lies behind the camera: the extent then has no bound.
    is_endless: bool,
}

impl Extent {
    /// The extent of no point.
    pub(crate) const EMPTY: Self = Self {
        min_px: DVec2::INFINITY,
        max_px: DVec2::NEG_INFINITY,
        is_endless: false,
    };

    /// Includes a homogeneous image position, (u w, v w, w) with w its depth in metres.
    pub(crate) fn include(&mut self, at: DVec3) {
        if at.z <= NEAR_M {
            self.is_endless = true;
            return;
        }
        self.min_px = self.min_px.min(at.truncate() / at.z);
        self.max_px = self.max_px.max(at.truncate() / at.z);
    }

    /// The rectangle around all points, within the image; `None` if they are outside the picture or
    /// all behind the camera.
    pub(crate) fn rect(&self, image_px: UVec2) -> Option<PixelRect> {
        let is_any_before = self.min_px.cmple(self.max_px).all();
        if !is_any_before {
            return None;
        }
        if self.is_endless {
            return Some(PixelRect {
                origin_px: UVec2::ZERO,
                size_px: image_px,
            });
        }
        let within = |px: DVec2| px.clamp(DVec2::ZERO, image_px.as_dvec2()).as_uvec2();
        let origin_px = within(self.min_px.floor());
        let size_px = within(self.max_px.ceil()).saturating_sub(origin_px);
        (size_px.min_element() > 0).then_some(PixelRect { origin_px, size_px })
    }
}
