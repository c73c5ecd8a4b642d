//! CPU reference of `things.wgsl`: the validity mask with other things in the picture.

use glam::{DMat3, DVec2, DVec3, DVec4, UVec2};

use super::model::centre_px;
use super::raster::Raster;

/// Code of a thing; 0 means none.
pub const THING: u8 = 1;
/// Code of a thing in front of the toy.
pub const BEFORE_TOY: u8 = 2;
/// Code of a plate that shows something else.
pub const WRONG_PLATE: u8 = 3;
/// Code of a plate that has a shadow of something else.
pub const SHADED_PLATE: u8 = 4;
/// Code of a thing that the toy hides.
pub const HIDDEN_THING: u8 = 5;
/// Code of a thing that the toy hides and no plate shows.
pub const PAINTED_THING: u8 = 6;
/// Light of such a thing with the largest codes, whose squares are proportional to light.
const MOST_PAINTED: f64 = 16.0;
/// Alpha of the marks of things, in the same order.
pub(super) const ALPHAS: [f64; 2] = [0.8, 0.6];
/// Less of the alpha on a pixel of another thing.
pub(super) const BEFORE_THING: f64 = 0.4;
/// Distance over which a pixel of the toy mixes with a thing in front of it, in pixels along each
/// side.
const MIXED_PX: f64 = 2.0;

/// Codes of a picture's pixels, and the homography from the region to that picture, as (u w, v w,
/// w).
#[derive(Clone, Debug)]
pub struct Things {
    /// One code per pixel, followed by the light of the three channels, of 255.
    pub codes: Raster<[u8; 4]>,
    /// Homography.
    pub codes_px_from_region_px: DMat3,
}

impl Things {
    /// The code at a place of the region; 0 outside of the picture, and behind its camera.
    #[must_use]
    pub fn at(&self, region_px: DVec2) -> u8 {
        self.with_light(region_px)[0]
    }

    pub(super) fn with_light(&self, region_px: DVec2) -> [u8; 4] {
        let at = self.codes_px_from_region_px * region_px.extend(1.0);
        if at.z <= 0.0 {
            return [0; 4];
        }
        let px = (at.truncate() / at.z).floor();
        let is_inside = px.cmpge(DVec2::ZERO).all() && px.cmplt(self.codes.size().as_dvec2()).all();
        if is_inside {
            self.codes.at(px.as_uvec2())
        } else {
            [0; 4]
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
    let codes = [ALPHAS, ALPHAS.map(|alpha| alpha - BEFORE_THING)];
    let is_marked = codes
        .as_flattened()
        .iter()
        .any(|alpha| (marks.w - alpha).abs() < 0.01);
    let clear = if is_marked { marks.z } else { marks.x };
    let alphas = codes[usize::from(is_marked)];
    match things.at(at) {
        THING | HIDDEN_THING | PAINTED_THING => DVec4::new(0.0, of_toy, clear, alphas[0]),
        BEFORE_TOY => DVec4::new(0.0, 0.0, clear, alphas[1]),
        _ => DVec4::new(marks.x, of_toy, marks.z, marks.w),
    }
}

/// Factors of a texel's plate, of colour and alpha.
#[must_use]
pub fn plate_factors(things: &Things, texel: UVec2) -> DVec4 {
    let [code, light @ ..] = things.with_light(centre_px(texel));
    let light = DVec3::from_array(light.map(|light| f64::from(light) / 255.0));
    match code {
        WRONG_PLATE => DVec4::ZERO,
        SHADED_PLATE => light.max(DVec3::splat(0.00392)).recip().extend(1.0),
        HIDDEN_THING => light.extend(1.0),
        PAINTED_THING => (MOST_PAINTED * light * light).extend(1.0),
        _ => DVec4::ONE,
    }
}
