//! The toy's shadow on itself, from depth maps of points of a light.
//!
//! Source: Williams 1978, Heckbert and Herf 1997, Holbert 2011.

use glam::{DMat3, DVec2, DVec3, IVec2};

use crate::raster::{Coverage, Rasterizer, project};
use crate::shape::Shape;
use app_scene::scene::Intrinsics;

/// Side of a map.
const SIDE_PX: i32 = 192;
/// Relative depth within which a point counts as the visible one.
const SAME_DEPTH: f64 = 2e-4;
/// Offset of a point along its normal, in pixels of the map.
const LIFTED_PX: f64 = 1.5;
/// Distance in radii of the toy below which a point of a light has no usable depth map.
const NEAREST: f64 = 1.2;

/// Depth map of the toy from a point of a light.
pub(super) struct LightDepth {
    eye: DVec3,
    light_from_camera: DMat3,
    intrinsics: Intrinsics,
    depths: Coverage,
}

impl LightDepth {
    /// The map from a point in camera space; `None` if it is too close to the toy.
    pub(super) fn new(raster: &mut Rasterizer, shape: &Shape, eye: DVec3) -> Option<Self> {
        let back = eye - shape.centre;
        let distance = back.length();
        if distance < NEAREST * shape.radius_m {
            return None;
        }
        let z = back / distance;
        let x = z.any_orthonormal_vector();
        let light_from_camera = DMat3::from_cols(x, z.cross(x), z).transpose();
        let slope = shape.radius_m / (distance * distance - shape.radius_m * shape.radius_m).sqrt();
        let half_px = 0.5 * f64::from(SIDE_PX);
        let intrinsics = Intrinsics {
            fx_px: 0.95 * half_px / slope,
            fy_px: 0.95 * half_px / slope,
            cx_px: half_px,
            cy_px: half_px,
        };
        let points = shape
            .points
            .iter()
            .map(|point| light_from_camera * (*point - eye));
        let corners = project(points, &intrinsics);
        Some(Self {
            depths: raster.with_depth(&corners, &shape.faces, IVec2::splat(SIDE_PX)),
            eye,
            light_from_camera,
            intrinsics,
        })
    }

    /// Visible share of a light's point, at a surface that faces it with the given cosine.
    pub(super) fn visible(&self, point: DVec3, normal: DVec3, cosine: f64) -> f64 {
        let pixel_m = (point - self.eye).length() / self.intrinsics.fx_px;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let lifted = self.light_from_camera * (point + LIFTED_PX * pixel_m * sine * normal - self.eye);
        let depth_m = -lifted.z;
        let at =
            DVec2::new(lifted.x, -lifted.y) * self.intrinsics.fx_px / depth_m + self.intrinsics.cx_px - 0.5;
        let (low, between) = (at.floor(), at - at.floor());
        let [x, y] = [between.x, between.y];
        let four = [
            (IVec2::ZERO, (1.0 - x) * (1.0 - y)),
            (IVec2::X, x * (1.0 - y)),
            (IVec2::Y, (1.0 - x) * y),
            (IVec2::ONE, x * y),
        ];
        let passes = |step: IVec2| {
            f64::from(self.depths.depth_m(low.as_ivec2() + step)) >= depth_m * (1.0 - SAME_DEPTH)
        };
        four.iter()
            .filter(|(step, _)| passes(*step))
            .map(|(_, weight)| weight)
            .sum()
    }
}
