//! CPU reference of `on_things.wgsl`: the toy's shadow on things.

use glam::{DVec2, DVec3, DVec4, UVec2};

use super::composite::{KEEP_ALL, KEEP_NONE};
use super::model::{Pictures, Region, Solution, centre_px};
use super::raster::Raster;
use super::things::{ALPHAS, BEFORE_THING, BEFORE_TOY, THING, Things};

/// Alphas of the plate between which a pixel is relit: at the first it is shown as it is, at the second all of it
/// is made.
pub const RELIT: [f64; 2] = [0.5, 0.75];
/// Metres per step of a height.
const HEIGHT_STEP_M: f64 = 1e-5;
/// Distance of further changes that count.
const NEARBY_PX: f64 = 3.0;

/// Inputs beside those of all passes.
#[derive(Clone, Copy, Debug)]
pub struct Shaded<'a> {
    /// Marks with heights.
    pub things: &'a Things,
    /// Marks of the frame.
    pub validity: &'a Raster<DVec4>,
    /// Alpha of the plate.
    pub photographed: &'a Raster<f64>,
    /// Visibility of each light with the shown toy.
    pub shown: &'a Raster<DVec4>,
    /// The camera, in anchor space.
    pub camera_in_anchor: DVec3,
}

/// The plate at a texel, or what is shown there of a thing in the toy's shadow.
#[must_use]
pub fn on_things(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    shaded: &Shaded<'_>,
    texel: UVec2,
) -> DVec4 {
    let plate = pictures.plate.at(texel).extend(shaded.photographed.at(texel));
    let Some((point, of_lights)) = thing_point(region, shaded, texel) else {
        return plate;
    };
    let fractions = &solution.receivers[0].direct_fractions;
    let mean = fractions.iter().sum::<DVec3>().element_sum() / 3.0;
    let marks = shaded.validity.at(texel);
    let is_hidden = ALPHAS
        .iter()
        .any(|alpha| (marks.w - alpha + BEFORE_THING).abs() < 0.01);
    if plate.w < 1.0 || mean <= 0.0 || is_hidden {
        return plate;
    }
    let total = of_lights * fractions.iter().sum::<DVec3>() / mean;
    let (mut left, mut change) = (DVec3::ONE, DVec3::ZERO);
    for (i, (fraction, intensity)) in fractions.iter().zip(&solution.intensities).enumerate() {
        let share = of_lights * *fraction / mean / total.max(DVec3::ONE);
        let visible = |offset_px: DVec2| {
            let at = shadow_px(region, i, point).map(|at| at + offset_px);
            [&pictures.visibility, shaded.shown]
                .map(|map| at.map_or(1.0, |at| visible_at(region, map, (i, at))))
        };
        let around = [DVec2::ZERO, DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
        let changes = around.map(|offset| {
            let [before, after] = visible(NEARBY_PX * offset);
            (before - after).abs()
        });
        left -= share * (1.0 - *intensity * visible(DVec2::ZERO)[1]);
        change += share * *intensity * changes.into_iter().fold(0.0, f64::max);
    }
    let part = ((change.max_element() - KEEP_ALL) / (KEEP_NONE - KEEP_ALL)).clamp(0.0, 1.0);
    let is_behind_toy = shaded.things.at(centre_px(texel)) == THING;
    let behind_toy = if is_behind_toy { 1.0 - marks.z } else { 0.0 };
    let made = (part * part * (3.0 - 2.0 * part)).max(behind_toy);
    if made == 0.0 {
        return plate;
    }
    let lit = plate.truncate() * left.max(DVec3::ZERO);
    (pictures.frame.at(texel) / solution.gain)
        .lerp(lit, made)
        .extend(RELIT[0] + made * (RELIT[1] - RELIT[0]))
}

/// The point of a thing in anchor space, and the lights' share of its light; `None` if there is none.
fn thing_point(region: &Region, shaded: &Shaded<'_>, texel: UVec2) -> Option<(DVec3, f64)> {
    let at = centre_px(texel);
    let [code, high, low, of_lights] = shaded.things.with_light(at);
    let height_m = f64::from(u16::from_be_bytes([high, low])) * HEIGHT_STEP_M;
    let eye = shaded.camera_in_anchor;
    let is_raised = (code == THING || code == BEFORE_TOY) && height_m > 0.0 && height_m < eye.y;
    let below = region.receivers[0].plane_point(at).filter(|_| is_raised)?;
    let point = DVec3::new(below.x, 0.0, below.y).lerp(eye, height_m / eye.y);
    Some((point, f64::from(of_lights) / 255.0))
}

/// The place of a point's shadow in the region's picture of the first receiver.
fn shadow_px(region: &Region, i: usize, point: DVec3) -> Option<DVec2> {
    let light = region.lights[i];
    let to_light = light.truncate() - light.w * point;
    if to_light.y <= 0.0 {
        return None;
    }
    let below = point - to_light * (point.y / to_light.y);
    region.receivers[0].region_px(DVec2::new(below.x, below.z))
}

/// A light's visibility at a place; 1 where the first receiver is not seen.
fn visible_at(region: &Region, map: &Raster<DVec4>, (i, at): (usize, DVec2)) -> f64 {
    let corner = (at - 0.5).floor();
    let part = at - 0.5 - corner;
    let texel = |x: f64, y: f64| {
        let texel = corner + DVec2::new(x, y);
        let is_in = texel.cmpge(DVec2::ZERO).all() && texel.cmplt(region.size_px.as_dvec2()).all();
        let receiver = region.receiver_point(texel + 0.5).map(|point| point.receiver);
        if is_in && receiver == Some(0) {
            map.at(texel.as_uvec2())[i]
        } else {
            1.0
        }
    };
    let row = |y: f64| texel(0.0, y) * (1.0 - part.x) + texel(1.0, y) * part.x;
    row(0.0) * (1.0 - part.y) + row(1.0) * part.y
}
