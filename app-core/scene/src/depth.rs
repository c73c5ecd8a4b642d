//! Depth pictures of camera frames.

use std::sync::Arc;

use glam::{DVec2, DVec3, IVec2, UVec2};

use crate::scene::Intrinsics;

/// Distances along the view of a camera, in a picture of its own resolution that shows what the
/// camera's picture shows.
#[derive(Clone, Debug)]
pub struct Depth {
    size_px: UVec2,
    /// In millimetres; 0 if unknown.
    depths_mm: Arc<[u16]>,
}

impl Depth {
    /// Depths in millimetres, rows from the top, 0 if unknown; `None` if their number is wrong.
    #[must_use]
    pub fn new(size_px: UVec2, depths_mm: impl Into<Arc<[u16]>>) -> Option<Self> {
        let depths_mm = depths_mm.into();
        let n_pixels = u64::from(size_px.x) * u64::from(size_px.y);
        (depths_mm.len() as u64 == n_pixels).then_some(Self { size_px, depths_mm })
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size_px(&self) -> UVec2 {
        self.size_px
    }

    /// Depths in millimetres, rows from the top, 0 if unknown.
    #[must_use]
    pub fn depths_mm(&self) -> &[u16] {
        &self.depths_mm
    }

    /// The part of the pixels whose depth is known.
    #[must_use]
    pub fn known(&self) -> f64 {
        let n_known = self.depths_mm.iter().filter(|depth_mm| **depth_mm > 0).count();
        n_known as f64 / self.depths_mm.len().max(1) as f64
    }

    /// The known pixels with the points at their centres, in the space of a camera whose picture has
    /// a size in pixels.
    pub fn points(&self, camera: Intrinsics, picture_px: UVec2) -> impl Iterator<Item = (IVec2, DVec3)> {
        let per_px = picture_px.as_dvec2() / self.size_px.as_dvec2();
        let pixels = (0..self.size_px.y).flat_map(|y| (0..self.size_px.x).map(move |x| UVec2::new(x, y)));
        let known = pixels
            .zip(self.depths_mm.iter())
            .filter(|(_, depth_mm)| **depth_mm > 0);
        known.map(move |(at, depth_mm)| {
            let at_px: DVec2 = (at.as_dvec2() + 0.5) * per_px;
            (at.as_ivec2(), 1e-3 * f64::from(*depth_mm) * camera.ray(at_px))
        })
    }
}

/// Millimetres of a depth in metres; 0, as if unknown, for a number that is no depth, or beyond 65 m.
#[must_use]
pub fn millimetres(metres: f32) -> u16 {
    let millimetres = (1e3 * metres).round();
    let is_known = millimetres > 0.0 && millimetres <= f32::from(u16::MAX);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within the range, as was just seen"
    )]
    let known = millimetres as u16;
    if is_known { known } else { 0 }
}
