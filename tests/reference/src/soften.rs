//! CPU reference of `soften.wgsl`: a plate, spread along one axis as light is.

use glam::{DVec2, DVec4, UVec2};

use super::model::centre_px;
use super::raster::Raster;

/// Standard deviation, in pixels, of what is not spread.
const LEAST_PX: f64 = 0.01;

/// An axis of a spread.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Of length 1, in pixels.
    pub direction: DVec2,
    /// Standard deviation along it.
    pub deviation_px: f64,
    /// Pixels to either side that are looked at.
    pub reach_px: u32,
}

/// Colour and alpha of a texel: the mean of what lies along the axis, by the weights of a normal distribution. Colours are those of the
/// texels times their alpha, and what has none gives and gets nothing.
#[must_use]
pub fn soften(plate: &Raster<DVec4>, axis: &Axis, texel: UVec2) -> DVec4 {
    let own = plate.at(texel);
    if own.w == 0.0 || axis.deviation_px < LEAST_PX {
        return own;
    }
    let steps = (0..=2 * axis.reach_px).map(|k| f64::from(k) - f64::from(axis.reach_px));
    let sum: DVec4 = steps
        .map(|step| {
            let weight = (-0.5 * (step / axis.deviation_px).powi(2)).exp();
            plate.bilinear(centre_px(texel) + step * axis.direction) * weight
        })
        .sum();
    (sum.truncate() / sum.w).extend(own.w)
}
