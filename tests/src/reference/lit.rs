//! CPU reference of `lit.wgsl`: what the receivers look like in the light, pooled on coarse grids.

use glam::DVec3;

use super::grid::{Cell, PlaneGrid};
use super::model::{Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;
use super::{ConstantError, shader_constant};

/// What the shader fixes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitConstants {
    /// A pixel counts with this power of the light that is left.
    pub power: f64,
    /// Share of a cell's points that must count for the cell to be known in full.
    pub full_share: f64,
    /// Points of a cell along each side.
    pub n_points: u32,
}

impl LitConstants {
    /// Reads them from the shader.
    ///
    /// # Errors
    /// When it has no such constant.
    pub fn from_shader() -> Result<Self, ConstantError> {
        Ok(Self {
            power: shader_constant("lit", "LIT_POWER")?,
            full_share: shader_constant("lit", "FULL_SHARE")?,
            n_points: shader_constant("lit", "N_POINTS")?,
        })
    }
}

/// Pools B = frame / (gain M) of one receiver over the cells of its grid. `pictures.seen` is 1 well clear of the toy; the
/// plate is not looked at.
#[must_use]
pub fn pool(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    constants: &LitConstants,
    (receiver, grid): (usize, &PlaneGrid),
) -> Raster<Cell> {
    let n_side = constants.n_points;
    let n_full = constants.full_share * f64::from(n_side * n_side);
    Raster::from_fn(grid.size, |cell| {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for texel in grid.texels_of(region, receiver, cell, n_side) {
            let at = centre_px(texel);
            let Some(point) = region
                .receiver_point(at)
                .filter(|_| pictures.seen.at(texel) > 0.0)
            else {
                continue;
            };
            let ambient = coarse_at(&pictures.ambient, region, at);
            let model = solution.receiver_model(region, point, ambient, pictures.visibility.at(texel));
            let left = model.min_element();
            if left > 0.0 {
                let weight = left.min(1.0).powf(constants.power);
                sum += weight * pictures.frame.at(texel) / (solution.gain * model);
                total += weight;
            }
        }
        if total == 0.0 {
            return Cell::default();
        }
        Cell {
            value: sum / total,
            certainty: (total / n_full).min(1.0),
        }
    })
}
