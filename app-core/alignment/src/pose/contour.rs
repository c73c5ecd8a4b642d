//! The toy's outline in the picture.

use glam::{DVec2, DVec3, IVec2};

use crate::raster::Coverage;
use app_scene::scene::Intrinsics;

/// Coverage of a pixel inside the outline.
const INSIDE: f32 = 0.5;
/// Threshold of the Sobel gradient, which is 4 for an axis-parallel edge, 4.2 for a diagonal one,
/// and less for a limb thinner than two pixels.
const LEAST_GRADIENT: f64 = 1.5;
/// Width of the picture's border without neighbours.
const BORDER_PX: i32 = 2;

/// A piece of the outline, about a pixel long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element {
    /// Its position.
    pub(super) at_px: DVec2,
    /// Unit vector out of the toy.
    pub(super) normal: DVec2,
    /// Its length.
    pub(super) length_px: f64,
    /// Depth of the toy's rim there.
    pub(super) depth_m: f64,
}

impl Element {
    /// The pixel at a distance from it, positive outside of the toy.
    pub(super) fn pixel(&self, distance_px: f64) -> IVec2 {
        (self.at_px + distance_px * self.normal).floor().as_ivec2()
    }

    /// The rim in camera space, and its shift along the normal in pixels per metre along each axis.
    ///
    /// The sliding of the rim over a curved surface as it turns is a second-order effect.
    pub(super) fn rim(&self, k: &Intrinsics) -> (DVec3, DVec3) {
        let slope_x = (self.at_px.x - k.cx_px) / k.fx_px;
        let slope_y = -(self.at_px.y - k.cy_px) / k.fy_px;
        let point = DVec3::new(slope_x, slope_y, -1.0) * self.depth_m;
        let (across, down) = (self.normal.x * k.fx_px, -self.normal.y * k.fy_px);
        let per_m = DVec3::new(across, down, across * slope_x + down * slope_y) / self.depth_m;
        (point, per_m)
    }
}

/// Pieces of the outline of the covered pixels, row by row.
pub(super) fn contour(coverage: &Coverage, size_px: IVec2) -> Vec<Element> {
    const NEIGHBOURS: [IVec2; 4] = [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y];
    let pixels = coverage.pixels().filter(|at| {
        let is_within = at.cmpge(IVec2::splat(BORDER_PX)).all() && at.cmplt(size_px - BORDER_PX).all();
        let is_covered = |at| coverage.at(at) >= INSIDE;
        is_within && is_covered(*at) && !NEIGHBOURS.iter().all(|step| is_covered(*at + *step))
    });
    pixels.filter_map(|at| element(coverage, at)).collect()
}

fn element(coverage: &Coverage, at: IVec2) -> Option<Element> {
    let near = |x, y| f64::from(coverage.at(at + IVec2::new(x, y)));
    let gradient = DVec2::new(
        near(1, -1) + 2.0 * near(1, 0) + near(1, 1) - near(-1, -1) - 2.0 * near(-1, 0) - near(-1, 1),
        near(-1, 1) + 2.0 * near(0, 1) + near(1, 1) - near(-1, -1) - 2.0 * near(0, -1) - near(1, -1),
    );
    if gradient.length() < LEAST_GRADIENT {
        return None;
    }
    let normal = -gradient.normalize();
    let across = normal.abs().max_element();
    Some(Element {
        at_px: at.as_dvec2() + 0.5 + normal * ((near(0, 0) - 0.5) * across),
        normal,
        length_px: 1.0 / across,
        depth_m: rim_depth_m(coverage, at)?,
    })
}

/// Depth at the pixel's centre, or the smallest beside it if the rim misses the centre.
fn rim_depth_m(coverage: &Coverage, at: IVec2) -> Option<f64> {
    let own_m = coverage.depth_m(at);
    let around = (-1..=1).flat_map(|y| (-1..=1).map(move |x| IVec2::new(x, y)));
    let nearest_m = match own_m.is_finite() {
        true => own_m,
        false => around
            .map(|step| coverage.depth_m(at + step))
            .fold(own_m, f32::min),
    };
    nearest_m.is_finite().then(|| f64::from(nearest_m))
}
