//! Twin of `residual.wgsl`: what the model leaves unexplained, pooled on coarse grids.

use app_core::gpu::layout::Grid;
use glam::{DVec2, DVec3, UVec2, Vec2};

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
            evidence: EvidenceRange::from_shader("residual")?,
            cauchy_scale: shader_constant("residual", "CAUCHY_SCALE")?,
            full_share: shader_constant("residual", "FULL_SHARE")?,
            n_points: shader_constant("residual", "N_POINTS")?,
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

/// Square cells over a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneGrid {
    /// Corner of the first cell, (x, z) in plane space.
    pub origin_in_plane: DVec2,
    /// Side of a cell.
    pub cell_m: f64,
    /// Cells along each side.
    pub size: UVec2,
}

impl From<&Grid> for PlaneGrid {
    fn from(grid: &Grid) -> Self {
        Self {
            origin_in_plane: Vec2::from(grid.origin_in_plane).as_dvec2(),
            cell_m: f64::from(grid.cell_m),
            size: grid.size.into(),
        }
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
        for k in 0..n_side * n_side {
            let within = (UVec2::new(k % n_side, k / n_side).as_dvec2() + 0.5) / f64::from(n_side);
            let in_plane = grid.origin_in_plane + (cell.as_dvec2() + within) * grid.cell_m;
            let texel = region.receivers[receiver]
                .region_px(in_plane)
                .filter(|px| px.cmpge(DVec2::ZERO).all() && px.cmplt(region.size_px.as_dvec2()).all())
                .map(DVec2::as_uvec2);
            let seen = texel.filter(|texel| {
                let hit = region.receiver_point(centre_px(*texel));
                pictures.seen.at(*texel) > 0.0 && hit.is_some_and(|hit| hit.receiver == receiver)
            });
            if let Some(texel) = seen {
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
            let usable = constants.evidence.holds(frame[channel], plate[channel]);
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
            residual: DVec3::new(ratio(0), ratio(1), ratio(2)),
            certainty: (self.n_points / n_full).min(1.0),
        }
    }
}
