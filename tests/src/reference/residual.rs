//! CPU reference of `residual.wgsl`: what the model leaves unexplained, pooled on coarse grids.

use glam::{DVec3, UVec2};

use super::grid::{Cell, PlaneGrid};
use super::model::{Pictures, Region, Solution, UsableRange, centre_px, coarse_at};
use super::raster::Raster;
use super::{ConstantError, shader_constant};

/// What the shader fixes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualConstants {
    /// Which values carry evidence.
    pub validity: UsableRange,
    /// Residual, as a fraction of the plate, at which a pixel counts half.
    pub cauchy_scale: f64,
    /// Share of a cell's points that must be evidence for the cell to count in full.
    pub full_share: f64,
    /// Points of a cell along each side.
    pub n_points: u32,
}

impl ResidualConstants {
    /// Reads them from the shader.
    ///
    /// # Errors
    /// When it has no such constant.
    pub fn from_shader() -> Result<Self, ConstantError> {
        Ok(Self {
            validity: UsableRange::from_shader("residual")?,
            cauchy_scale: shader_constant("residual", "CAUCHY_SCALE")?,
            full_share: shader_constant("residual", "FULL_SHARE")?,
            n_points: shader_constant("residual", "N_POINTS")?,
        })
    }
}

/// Pools the residual of one receiver over the cells of its grid, from nothing known before.
#[must_use]
pub fn pool(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    constants: &ResidualConstants,
    (receiver, grid): (usize, &PlaneGrid),
) -> Raster<Cell> {
    let n_side = constants.n_points;
    Raster::from_fn(grid.size, |cell| {
        let mut sums = Sums::default();
        for texel in grid.texels_of(region, receiver, cell, n_side) {
            if pictures.seen.at(texel) > 0.0 {
                sums.add(region, pictures, solution, constants, texel);
            }
        }
        sums.cell(constants.full_share * f64::from(n_side * n_side))
    })
}

#[derive(Default)]
struct Sums {
    /// Weighted products of plate and residual light.
    product: DVec3,
    /// Weighted squares of the plate.
    energy: DVec3,
    /// Points that are evidence, whether the model explains them or not.
    n_points: f64,
}

impl Sums {
    fn add(
        &mut self,
        region: &Region,
        pictures: &Pictures,
        solution: &Solution,
        constants: &ResidualConstants,
        texel: UVec2,
    ) {
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
        let unexplained = frame / solution.gain - plate * model;
        let relative = unexplained.length_squared() / (brightness * constants.cauchy_scale.powi(2));
        for channel in 0..3 {
            let usable = constants.validity.holds(frame[channel], plate[channel]);
            let usable = usable * pictures.seen.at(texel);
            let weight = usable / (1.0 + relative);
            self.product[channel] += weight * plate[channel] * unexplained[channel];
            self.energy[channel] += weight * plate[channel] * plate[channel];
            self.n_points += usable / 3.0;
        }
    }

    fn cell(&self, n_full: f64) -> Cell {
        let ratio = |channel: usize| {
            if self.energy[channel] > 0.0 {
                self.product[channel] / self.energy[channel]
            } else {
                0.0
            }
        };
        Cell {
            value: DVec3::new(ratio(0), ratio(1), ratio(2)),
            certainty: (self.n_points / n_full).min(1.0),
        }
    }
}
