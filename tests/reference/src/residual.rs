//! CPU reference of `residual.wgsl`: the model's residual, pooled on coarse grids.

use glam::{DVec3, UVec2};

use super::grid::{Cell, PlaneGrid, Taken, certainty};
use super::model::{Pictures, Region, Solution, centre_px, coarse_at, evidence};
use super::raster::Raster;

/// Residual, as a fraction of the plate, at which a pixel has half weight: larger ones are not part
/// of the model.
const CAUCHY_SCALE: f64 = 0.03;

/// Pools the residual of one receiver over the cells of its grid, without earlier values.
#[must_use]
pub fn pool(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    (receiver, grid): (usize, &PlaneGrid),
) -> Raster<Cell> {
    Raster::from_fn(grid.size, |cell| {
        let mut sums = Sums::default();
        for texel in grid.texels_of(region, receiver, cell, Taken::All) {
            if pictures.seen.at(texel) > 0.0 {
                sums.add(region, pictures, solution, texel);
            }
        }
        sums.cell()
    })
}

#[derive(Default)]
struct Sums {
    /// Weighted products of plate and residual light.
    product: DVec3,
    /// Weighted squares of the plate.
    energy: DVec3,
    /// Number of points that are evidence, whether the model explains them or not.
    n_points: f64,
}

impl Sums {
    fn add(&mut self, region: &Region, pictures: &Pictures, solution: &Solution, texel: UVec2) {
        let Some(point) = region.receiver_point(centre_px(texel)) else {
            return;
        };
        let (frame, plate) = (pictures.frame.at(texel), pictures.plate.at(texel));
        let brightness = plate.length_squared();
        if brightness == 0.0 {
            return;
        }
        let ambient = coarse_at(&pictures.ambient, region, centre_px(texel));
        let model = solution.receiver_model(region, point, ambient, pictures.visibility.at(texel));
        let reflected = region.reflected(point, pictures.visibility.at(texel));
        let unexplained = frame / solution.gain - reflected - plate * model;
        let relative = unexplained.length_squared() / (brightness * CAUCHY_SCALE.powi(2));
        for channel in 0..3 {
            let evidence = evidence(frame[channel], plate[channel]) * pictures.seen.at(texel);
            let weight = evidence / (1.0 + relative);
            self.product[channel] += weight * plate[channel] * unexplained[channel];
            self.energy[channel] += weight * plate[channel] * plate[channel];
            self.n_points += evidence / 3.0;
        }
    }

    fn cell(&self) -> Cell {
        let ratio = |channel: usize| {
            if self.energy[channel] > 0.0 {
                self.product[channel] / self.energy[channel]
            } else {
                0.0
            }
        };
        Cell {
            value: DVec3::new(ratio(0), ratio(1), ratio(2)),
            certainty: certainty(self.n_points, Taken::All),
        }
    }
}
