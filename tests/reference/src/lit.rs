//! CPU reference of `lit.wgsl`: unshadowed colours of the receivers, pooled on coarse grids.

use glam::DVec3;

use super::grid::{Cell, PlaneGrid, Taken, certainty};
use super::model::{Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;

/// Exponent of the remaining light in a pixel's weight: small in shadow, whose depth may not be
/// known yet.
const LIT_POWER: f64 = 8.0;

/// Pools B = (frame - gain reflected) / (gain M), 0 at least, of one receiver over the cells of its grid. `pictures.seen` is 1 well
/// clear of the toy; the plate is ignored.
#[must_use]
pub fn pool(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    (receiver, grid, taken): (usize, &PlaneGrid, Taken),
) -> Raster<Cell> {
    Raster::from_fn(grid.size, |cell| {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for texel in grid.texels_of(region, receiver, cell, taken) {
            let at = centre_px(texel);
            let Some(point) = region
                .receiver_point(at)
                .filter(|_| pictures.seen.at(texel) > 0.0)
            else {
                continue;
            };
            let ambient = coarse_at(&pictures.ambient, region, at);
            let visibility = pictures.visibility.at(texel);
            let model = solution.receiver_model(region, point, ambient, visibility);
            let left = model.min_element();
            if left > 0.0 {
                let weight = left.min(1.0).powf(LIT_POWER);
                let reflected = solution.gain * region.reflected(point, visibility);
                sum += weight * (pictures.frame.at(texel) - reflected) / (solution.gain * model);
                total += weight;
            }
        }
        if total == 0.0 {
            return Cell::default();
        }
        Cell {
            value: (sum / total).max(DVec3::ZERO),
            certainty: certainty(total, taken),
        }
    })
}
