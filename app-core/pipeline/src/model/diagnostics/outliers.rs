//! Outliers of the model: an object that is missing in the plate, or the shadow of a light that is
//! not listed.

use crate::frame::warning::Outlier;

/// Pooled residual, in units of the plate, from which `composite` begins to keep the camera's
/// pixels: enough to report a shadow.
pub const OUTLIER_NONE: f32 = 0.15;
/// Pooled residual from which `composite` keeps them in full.
pub const OUTLIER_ALL: f32 = 0.3;
/// Smallest ratio of a residual's lowest to its highest channel for which `composite` classifies it
/// as a shadow.
pub const SHADOW_EVENNESS: f32 = 0.4;
/// Minimum certainty of a cell, of 1 per frame.
const LEAST_CERTAINTY: f32 = 0.5;
/// Minimum number of cells; fewer are a slightly misplaced edge.
const FEWEST_CELLS: usize = 4;

/// Outliers in a receiver's cells, which hold residual times certainty, and certainty.
#[must_use]
pub fn outliers(accumulated: &[[f32; 4]]) -> Vec<Outlier> {
    let known = accumulated.iter().filter(|cell| cell[3] >= LEAST_CERTAINTY);
    let residuals = known.map(|[r, g, b, certainty]| [r, g, b].map(|sum| sum / certainty));
    let (mut n_objects, mut n_shadows) = (0, 0);
    for residual in residuals {
        let most = residual.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let least = residual.iter().copied().fold(f32::INFINITY, f32::min);
        let is_even = most < 0.0 && most / least >= SHADOW_EVENNESS;
        if is_even && -least >= OUTLIER_NONE {
            n_shadows += 1;
        } else if !is_even && most.max(-least) >= OUTLIER_ALL {
            n_objects += 1;
        }
    }
    let found = [(n_objects, Outlier::Object), (n_shadows, Outlier::Shadow)];
    found
        .into_iter()
        .filter(|(n_cells, _)| *n_cells >= FEWEST_CELLS)
        .map(|(_, unknown)| unknown)
        .collect()
}
