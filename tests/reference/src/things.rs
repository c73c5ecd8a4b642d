//! CPU reference of `things.wgsl`: the validity mask with other things in the picture.

use glam::{DMat3, DVec2, DVec3, DVec4, IVec2, UVec2};

use super::estimate::ESTIMATED;
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
/// Code of a plate that is completed by the place's pattern.
pub const COMPLETED_PLATE: u8 = 7;
/// Light of such a plate with the largest codes, whose squares are proportional to light.
const MOST_COMPLETED: f64 = 64.0;
/// Light of a painted thing with the largest codes, whose squares are proportional to light.
const MOST_PAINTED: f64 = 16.0;
/// Alpha of the marks of things, in the same order.
pub(super) const ALPHAS: [f64; 2] = [0.8, 0.6];
/// Less of the alpha on a pixel of another thing.
pub(super) const BEFORE_THING: f64 = 0.4;
/// Distance over which a pixel of the toy mixes with a thing in front of it, in pixels along each
/// side.
const MIXED_PX: f64 = 2.0;

/// Directions in which a thing ends at its rim, in the order of their codes: first those of pixels
/// outside its marks, then of those inside.
const DIRECTIONS: [[i32; 2]; 8] = [
    [-1, -1],
    [0, -1],
    [1, -1],
    [-1, 0],
    [1, 0],
    [-1, 1],
    [0, 1],
    [1, 1],
];

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

/// Steps from a pixel at a thing's rim, by its code from 1 to 16: to one within the thing, and to one
/// beyond it.
#[must_use]
pub fn rim_steps(code: usize) -> [IVec2; 2] {
    let [x, y] = DIRECTIONS[(code - 1) % 8];
    let outward = IVec2::new(x, y);
    let is_inside = code > 8;
    let n_steps = if is_inside { [-1, 2] } else { [-2, 1] };
    n_steps.map(|n| n * outward)
}

/// The code of a texel at a thing's rim, and that of the thing's marks; `None` if it is at none.
fn rim(things: &Things, size: UVec2, at: DVec2) -> Option<(usize, u8)> {
    let shows = |at: DVec2| [THING, BEFORE_TOY].contains(&things.at(at));
    let beside = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
    if beside.iter().all(|step| shows(at + *step) == shows(at)) {
        return None;
    }
    let steps = (-2..=2).flat_map(|y| (-2..=2).map(move |x| IVec2::new(x, y).as_dvec2()));
    let weighted = steps.filter(|step| *step != DVec2::ZERO).map(|step| {
        let weighted = step / step.length_squared();
        if shows(at + step) { -weighted } else { weighted }
    });
    let sum: DVec2 = weighted.sum();
    if sum == DVec2::ZERO {
        return None;
    }
    let to_eighth = (sum.to_angle() / std::f64::consts::FRAC_PI_4).round() * std::f64::consts::FRAC_PI_4;
    let outward = DVec2::from_angle(to_eighth).round().as_ivec2().to_array();
    let number = DIRECTIONS.iter().position(|direction| *direction == outward)?;
    let code = 1 + number + if shows(at) { 8 } else { 0 };
    let [within, beyond] = rim_steps(code).map(|step| at + step.as_dvec2());
    let is_in = [within, beyond]
        .iter()
        .all(|at| at.cmpgt(DVec2::ZERO).all() && at.cmplt(size.as_dvec2()).all());
    (is_in && shows(within) && !shows(beyond)).then(|| (code, things.at(within)))
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
    let rim = rim(things, validity.size(), at).filter(|_| !is_marked);
    let above = rim.map_or(0.0, |(code, _)| code as f64 / 255.0);
    let of_thing = rim.map(|(_, thing)| thing);
    let above_thing = if marks.x == 1.0 { above } else { 0.0 };
    match things.at(at) {
        BEFORE_TOY => DVec4::new(0.0, 0.0, clear, alphas[1] + above),
        _ if of_thing == Some(BEFORE_TOY) => DVec4::new(0.0, 0.0, marks.z, ALPHAS[1] + above),
        THING | HIDDEN_THING | PAINTED_THING => DVec4::new(0.0, of_toy, clear, alphas[0] + above_thing),
        _ if above_thing > 0.0 => DVec4::new(0.0, of_toy, marks.z, ALPHAS[0] + above_thing),
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
        COMPLETED_PLATE => (MOST_COMPLETED * light * light).extend(ESTIMATED),
        PAINTED_THING => (MOST_PAINTED * light * light).extend(1.0),
        _ => DVec4::ONE,
    }
}
