//! CPU reference of `common/behind_outline.wgsl`: the background of the toy's outline in a blurred picture.

use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};

use super::occlusion::{PointSpread, spread_position};
use super::raster::Raster;

/// Number of positions of a pixel, and rows from one to the next.
const N_PLACES: u32 = 32;
const ROW_STEP: u32 = 9;

/// The change of the plate in a photograph's light, by `gain`, from a texel `in_region`, which is `in_box` in
/// the toy's box, to the part that the toy leaves free; 0 if no plate shows one of them. `covered` is the
/// toy's share of each texel of its box, and `spread` that of the picture.
#[must_use]
pub fn plate_change(
    plate: &Raster<DVec4>,
    covered: &Raster<f64>,
    (spread, gain): (PointSpread, DVec3),
    [in_region, in_box]: [UVec2; 2],
) -> DVec3 {
    let last = covered.size().as_ivec2() - 1;
    let free = (0..N_PLACES).map(|k| {
        let column = (f64::from(k) + 0.5) / f64::from(N_PLACES);
        let row = (f64::from(k * ROW_STEP % N_PLACES) + 0.5) / f64::from(N_PLACES);
        let from_px = spread_position(DVec2::new(column, row), spread) - 0.5;
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
    if own.w.min(seen.w) < 1.0 - 1e-9 {
        return DVec3::ZERO;
    }
    gain * (seen - own).truncate()
}
