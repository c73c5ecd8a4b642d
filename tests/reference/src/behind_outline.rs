//! CPU reference of `common/behind_outline.wgsl`: the background of the toy's outline in a blurred picture.

use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};

use super::occlusion::{PointSpread, spread_position};
use super::raster::Raster;

/// Number of positions of a pixel, and rows from one to the next.
const N_PLACES: u32 = 32;
const ROW_STEP: u32 = 9;

/// Middle of the places around a texel `in_box` of the toy's box that the toy leaves free, in pixels from its
/// centre. `covered` is the toy's share of each texel, and `spread` that of the picture.
#[must_use]
pub fn middle_of_free_px(covered: &Raster<f64>, spread: PointSpread, in_box: UVec2) -> DVec2 {
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
    if n_free > 0.0 {
        sum_px / n_free
    } else {
        DVec2::ZERO
    }
}

/// The change of the plate in a photograph's light, by `gain`, from a texel of the region to a place that is
/// `middle_px` from its centre; 0 if no plate shows one of them.
#[must_use]
pub fn plate_change(plate: &Raster<DVec4>, gain: DVec3, texel: UVec2, middle_px: DVec2) -> DVec3 {
    let own = plate.at(texel);
    let seen = beside(plate, texel, middle_px);
    if own.w.min(seen.w) < 1.0 - 1e-9 {
        return DVec3::ZERO;
    }
    gain * (seen - own).truncate()
}

/// A map of which each texel is the mean over it and its neighbours: those beside it have the weight `side`
/// each, along rows and along columns.
#[must_use]
pub fn softened(map: &Raster<DVec4>, side: f64) -> Raster<DVec4> {
    let last = map.size().as_ivec2() - 1;
    let weight = |step: i32| if step == 0 { 1.0 - 2.0 * side } else { side };
    Raster::from_fn(map.size(), |at| {
        let around = (-1..=1).flat_map(|y| (-1..=1).map(move |x| IVec2::new(x, y)));
        let parts = around.map(|step| {
            let near = (at.as_ivec2() + step).clamp(IVec2::ZERO, last).as_uvec2();
            weight(step.x) * weight(step.y) * map.at(near)
        });
        parts.sum()
    })
}

/// A map of the region at that place.
#[must_use]
pub fn beside(map: &Raster<DVec4>, texel: UVec2, middle_px: DVec2) -> DVec4 {
    map.bilinear(texel.as_dvec2() + 0.5 + middle_px)
}
