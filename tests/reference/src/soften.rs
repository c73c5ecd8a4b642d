//! CPU reference of `soften.wgsl`: a plate, blurred in linear light.

use glam::{DVec2, DVec4, UVec2};

use super::model::centre_px;
use super::raster::Raster;

/// Taps along the axes of a blur.
#[derive(Clone, Copy, Debug)]
pub struct Taps {
    /// Steps between taps along each axis, in pixels.
    pub steps_px: [DVec2; 2],
    /// The same in standard deviations, for their weights; 0 for equal weights.
    pub spacing: DVec2,
    /// Number of taps on either side of the centre.
    pub n_beside: u32,
}

/// Colour and alpha of a texel: the mean of its surroundings, with Gaussian or equal weights. Colours are
/// weighted by their alpha, and texels without alpha do not take part.
#[must_use]
pub fn soften(plate: &Raster<DVec4>, taps: &Taps, texel: UVec2) -> DVec4 {
    let own = plate.at(texel);
    if own.w == 0.0 {
        return own;
    }
    let along = || (0..=2 * taps.n_beside).map(|k| f64::from(k) - f64::from(taps.n_beside));
    let grid = along().flat_map(|first| along().map(move |second| DVec2::new(first, second)));
    let sum: DVec4 = grid
        .map(|tap| {
            let weight = (-0.5 * (taps.spacing * tap).length_squared()).exp();
            let offset_px = tap.x * taps.steps_px[0] + tap.y * taps.steps_px[1];
            plate.bilinear(centre_px(texel) + offset_px) * weight
        })
        .sum();
    (sum.truncate() / sum.w).extend(own.w)
}
