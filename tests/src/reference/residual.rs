//! Twin of `residual.wgsl`: what the model leaves unexplained, pooled on a coarse grid.

use glam::{DVec3, UVec2};

use super::model::{EvidenceRange, Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;
use super::{ConstantError, shader_constant};

/// What the shader fixes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualConstants {
    /// Which values carry evidence.
    pub evidence: EvidenceRange,
    /// Residual, as a fraction of the plate, at which a pixel counts half.
    pub cauchy_scale: f64,
    /// Share of a cell's pixels that must be evidence for the cell to count in full.
    pub full_share: f64,
}

impl ResidualConstants {
    /// Reads them from the shader.
    ///
    /// # Errors
    /// When it has no such constant.
    pub fn from_shader() -> Result<Self, ConstantError> {
        Ok(Self {
            evidence: EvidenceRange::from_shader("residual")?,
            cauchy_scale: shader_constant("residual", "CAUCHY_SCALE")?,
            full_share: shader_constant("residual", "FULL_SHARE")?,
        })
    }
}

/// A cell of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Residual per channel, in plates.
    pub residual: DVec3,
    /// How far the residual is known, from 0 to 1.
    pub certainty: f64,
}

/// Pools the residual over cells of `cell_px` by `cell_px` pixels.
#[must_use]
pub fn pool(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    constants: &ResidualConstants,
    cell_px: u32,
) -> Raster<Cell> {
    let grid = (region.size_px + cell_px - 1) / cell_px;
    Raster::from_fn(grid, |cell| {
        let first = cell * cell_px;
        let inside = Raster::from_fn((region.size_px - first).min(UVec2::splat(cell_px)), |at| {
            first + at
        });
        let mut sums = Sums::default();
        for texel in inside
            .texels()
            .iter()
            .filter(|texel| pictures.seen.at(**texel) > 0.0)
        {
            sums.add(region, pictures, solution, constants, *texel);
        }
        let n_full = constants.full_share * f64::from(cell_px * cell_px);
        sums.cell(n_full)
    })
}

#[derive(Default)]
struct Sums {
    /// Weighted products of plate and residual light.
    product: DVec3,
    /// Weighted squares of the plate.
    energy: DVec3,
    n_pixels: f64,
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
        let Some(in_plane) = region.receiver_point(centre_px(texel)) else {
            return;
        };
        let (frame, plate) = (pictures.frame.at(texel), pictures.plate.at(texel));
        let brightness = plate.length_squared();
        if brightness == 0.0 {
            return;
        }
        let ambient = coarse_at(&pictures.ambient, region, centre_px(texel));
        let model = solution.receiver_model(region, in_plane, ambient, pictures.visibility.at(texel));
        let unexplained = frame - plate * model;
        let relative = unexplained.length_squared() / (brightness * constants.cauchy_scale.powi(2));
        for channel in 0..3 {
            let usable = constants.evidence.holds(frame[channel], plate[channel]);
            let weight = usable * pictures.seen.at(texel) / (1.0 + relative);
            self.product[channel] += weight * plate[channel] * unexplained[channel];
            self.energy[channel] += weight * plate[channel] * plate[channel];
            self.n_pixels += weight / 3.0;
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
            residual: DVec3::new(ratio(0), ratio(1), ratio(2)),
            certainty: (self.n_pixels / n_full).min(1.0),
        }
    }
}
