//! Coverage of a camera's picture by a mesh, for drawing over the picture.

use glam::{DVec2, DVec3, UVec2};

use crate::raster::{Rasterizer, project};
use app_scene::geometry::edges::Faces;
use app_scene::scene::Intrinsics;

/// Coverage by a mesh, over the rectangle of the picture that contains it.
#[derive(Clone, Debug, PartialEq)]
pub struct Silhouette {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Upper left and lower right corner of the rectangle, in pixels of the picture.
    pub corners_px: [DVec2; 2],
    /// 0 to 255 for each cell, rows from the top.
    pub coverage: Vec<u8>,
}

impl Silhouette {
    /// Coverage by faces whose points are in camera space, with at most that many cells along the
    /// picture's longer side; `None` if they are out of the picture.
    pub fn of(
        points: impl IntoIterator<Item = DVec3>,
        faces: &Faces,
        (intrinsics, size_px): (&Intrinsics, [u32; 2]),
        most: u32,
    ) -> Option<Self> {
        let longer = size_px[0].max(size_px[1]).max(1);
        let scale = (f64::from(most) / f64::from(longer)).min(1.0);
        let k = intrinsics.scaled(scale);
        let size = (scale * UVec2::from(size_px).as_dvec2()).ceil().as_ivec2();
        let corners = project(points, &k);
        let coverage = Rasterizer::default().coverage(&corners, faces, size);
        let rectangle = coverage.size_px.max(glam::IVec2::ZERO).as_uvec2();
        if rectangle.min_element() == 0 {
            return None;
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let codes = coverage
            .pixels()
            .map(|at| (255.0 * coverage.at(at)).round() as u8);
        let origin = coverage.origin_px.as_dvec2();
        Some(Self {
            size: rectangle.to_array(),
            corners_px: [origin, origin + rectangle.as_dvec2()].map(|corner| corner / scale),
            coverage: codes.collect(),
        })
    }
}
