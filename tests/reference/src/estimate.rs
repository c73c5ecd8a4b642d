//! CPU reference of `estimate.wgsl`: the plate, with an estimate for unphotographed parts.

use glam::{DVec3, DVec4, UVec2};

use super::grid::PlaneGrid;
use super::model::{Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;
use super::smoothstep;

/// Alpha of an estimated pixel, which is its weight in the fit.
pub const ESTIMATED: f64 = 0.25;
/// Remaining light, in plates, from which a pixel determines its own plate fully.
const TELLS_ALL: f64 = 0.3;
/// Remaining light, in plates, up to which a pixel does not determine its own plate at all.
const TELLS_NONE: f64 = 0.1;

/// The inputs of the estimate.
#[derive(Clone, Debug)]
pub struct Known<'a> {
    /// The pictures; `seen` is 1 well clear of the toy.
    pub pictures: &'a Pictures,
    /// 1 where the plate was photographed, [`ESTIMATED`] where it has the place's pattern.
    pub photographed: &'a Raster<f64>,
    /// The fit's result.
    pub solution: &'a Solution,
    /// For each receiver, filled unshadowed colours, and the positions of their cells.
    pub lit: &'a [(PlaneGrid, Raster<DVec3>)],
}

/// Linear colour and alpha of the plate at `texel`: smooth for the fits, and finally each visible
/// pixel's own.
#[must_use]
pub fn complete(region: &Region, known: &Known<'_>, is_final: bool, texel: UVec2) -> DVec4 {
    let (at, pictures) = (centre_px(texel), known.pictures);
    let photographed = pictures.plate.at(texel).extend(known.photographed.at(texel));
    let point = region.receiver_point(at).filter(|_| photographed.w < 1.0);
    let Some(point) = point else {
        return photographed;
    };
    let (grid, lit) = &known.lit[point.receiver];
    let smooth = if photographed.w == ESTIMATED {
        photographed.truncate()
    } else {
        grid.value_at(lit, point.in_plane)
    };
    let ambient = coarse_at(&pictures.ambient, region, at);
    let (solution, visibility) = (known.solution, pictures.visibility.at(texel));
    let model = solution.receiver_model(region, point, ambient, visibility);
    let told = smoothstep(TELLS_NONE, TELLS_ALL, model.min_element());
    if !is_final || pictures.seen.at(texel) == 0.0 || told == 0.0 {
        return smooth.extend(ESTIMATED);
    }
    let light = pictures.frame.at(texel) - solution.gain * region.reflected(point, visibility);
    let own = light.max(DVec3::ZERO) / (solution.gain * model);
    smooth.lerp(own, told).extend(ESTIMATED)
}
