//! CPU reference of `things.wgsl`: the validity mask with other things in the picture.

use glam::{DMat3, DVec2, DVec4, UVec2};

use super::model::centre_px;
use super::raster::Raster;

/// Code of a thing; 0 means none.
pub const THING: u8 = 1;
/// Code of a thing in front of the toy.
pub const BEFORE_TOY: u8 = 2;
/// Code of a plate that shows something else.
pub const WRONG_PLATE: u8 = 3;
/// Alpha of the marks of things, in the same order.
const ALPHAS: [f64; 2] = [0.8, 0.6];
/// Distance over which a pixel of the toy mixes with a thing in front of it, in pixels along each
/// side.
const MIXED_PX: f64 = 2.0;

/// Codes of a picture's pixels, and the homography from the region to that picture, as (u w, v w,
/// w).
#[derive(Clone, Debug)]
pub struct Things {
    /// One code per pixel.
    pub codes: Raster<u8>,
    /// Homography.
    pub codes_px_from_region_px: DMat3,
}

impl Things {
    /// The code at a place of the region; 0 outside of the picture, and behind its camera.
    #[must_use]
    pub fn at(&self, region_px: DVec2) -> u8 {
        let at = self.codes_px_from_region_px * region_px.extend(1.0);
        if at.z <= 0.0 {
            return 0;
        }
        let px = (at.truncate() / at.z).floor();
        let is_inside = px.cmpge(DVec2::ZERO).all() && px.cmplt(self.codes.size().as_dvec2()).all();
        if is_inside {
            self.codes.at(px.as_uvec2())
        } else {
            0
        }
    }
}

/// A texel's marks of `validity`, with things.
#[must_use]
pub fn mark(things: &Things, validity: &Raster<DVec4>, texel: UVec2) -> DVec4 {
    let (marks, at) = (validity.at(texel), centre_px(texel));
    let steps = [-MIXED_PX, 0.0, MIXED_PX];
    let mut around = steps.iter().flat_map(|y| steps.map(|x| at + DVec2::new(x, *y)));
    let of_toy = if around.any(|at| things.at(at) == BEFORE_TOY) {
        0.0
    } else {
        marks.y
    };
    match things.at(at) {
        THING => DVec4::new(0.0, of_toy, marks.x, ALPHAS[0]),
        BEFORE_TOY => DVec4::new(0.0, 0.0, marks.x, ALPHAS[1]),
        _ => DVec4::new(marks.x, of_toy, marks.z, marks.w),
    }
}
