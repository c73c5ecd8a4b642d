//! CPU reference of `common/behind_outline.wgsl`: the background of the toy's outline in a blurred picture.

use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};

use super::occlusion::spread_position;
use super::raster::Raster;

/// Number of positions of a pixel, and rows from one to the next.
const N_PLACES: u32 = 32;
const ROW_STEP: u32 = 9;

/// The background at a texel `in_region`, which is `in_box` in the toy's box, if `color` is its colour by
/// the plate there: that of the plate where the toy leaves it free, in the same light, or in all light if
/// there is more. `covered` is the toy's share of each texel of its box, and `root` that of the blur's
/// covariance.
#[must_use]
pub fn behind_outline(
    plate: &Raster<DVec4>,
    covered: &Raster<f64>,
    (root, gain, color): ([f64; 3], DVec3, DVec3),
    [in_region, in_box]: [UVec2; 2],
) -> DVec3 {
    let last = covered.size().as_ivec2() - 1;
    let free = (0..N_PLACES).map(|k| {
        let column = (f64::from(k) + 0.5) / f64::from(N_PLACES);
        let row = (f64::from(k * ROW_STEP % N_PLACES) + 0.5) / f64::from(N_PLACES);
        let from_px = spread_position(DVec2::new(column, row), root) - 0.5;
        let place = (in_box.as_dvec2() + 0.5 + from_px).floor().as_ivec2();
        let place = place.clamp(IVec2::ZERO, last).as_uvec2();
        (from_px, 1.0 - covered.at(place))
    });
    let (sum_px, n_free) = free.fold((DVec2::ZERO, 0.0), |(sum_px, n), (from_px, part)| {
        (sum_px + part * from_px, n + part)
    });
    let middle_px = if n_free > 0.0 {
        sum_px / n_free
    } else {
        DVec2::ZERO
    };
    let own = plate.at(in_region);
    let seen = plate.bilinear(in_region.as_dvec2() + 0.5 + middle_px);
    let lit = gain.dot(own.truncate());
    if seen.w < 1.0 - 1e-9 || lit <= 0.0 {
        return color;
    }
    let left = (color.element_sum() / lit).min(1.0);
    (color + left * gain * (seen - own).truncate()).max(DVec3::ZERO)
}
