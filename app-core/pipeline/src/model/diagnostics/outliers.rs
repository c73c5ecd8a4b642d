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
/// Minimum number of cells of an object; fewer are a place that is not well explained.
const FEWEST_CELLS: usize = 4;
/// Width from which a shadow is no misplaced edge, in cells and in metres: twice as wide as the band
/// that an edge 5 mm off left on the small side of a book, in 40 cells of 1 to 2 mm.
const NARROWEST_CELLS: usize = 2;
const NARROWEST_M: f32 = 0.010;

/// The cells of a receiver.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverCells<'a> {
    /// Row by row: residual times certainty, and certainty.
    pub accumulated: &'a [[f32; 4]],
    /// Number of cells in a row.
    pub width: usize,
    /// Side of a cell in metres; 0 on a receiver that is not reached.
    pub cell_m: f32,
}

/// Outliers on a receiver.
#[must_use]
pub fn outliers(cells: &ReceiverCells<'_>) -> Vec<Outlier> {
    let kinds: Vec<_> = cells.accumulated.iter().map(kind).collect();
    let n_objects = kinds.iter().filter(|kind| **kind == Some(Outlier::Object));
    let has_object = n_objects.count() >= FEWEST_CELLS;
    let is_shadow = |index: usize| kinds[index] == Some(Outlier::Shadow);
    let widest = widest_square((kinds.len(), cells.width), is_shadow);
    let has_shadow = widest >= NARROWEST_CELLS && widest as f32 * cells.cell_m >= NARROWEST_M;
    let found = [(has_object, Outlier::Object), (has_shadow, Outlier::Shadow)];
    let found = found.into_iter().filter(|(is_found, _)| *is_found);
    found.map(|(_, unknown)| unknown).collect()
}

/// What a cell shows, if it is unexplained.
fn kind([r, g, b, certainty]: &[f32; 4]) -> Option<Outlier> {
    if *certainty < LEAST_CERTAINTY {
        return None;
    }
    let residual = [r, g, b].map(|sum| sum / certainty);
    let most = residual.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let least = residual.iter().copied().fold(f32::INFINITY, f32::min);
    let is_even = most < 0.0 && most / least >= SHADOW_EVENNESS;
    if is_even && -least >= OUTLIER_NONE {
        Some(Outlier::Shadow)
    } else if !is_even && most.max(-least) >= OUTLIER_ALL {
        Some(Outlier::Object)
    } else {
        None
    }
}

/// Side of the largest square of cells that all satisfy a condition, of cells in rows of a width.
fn widest_square((n_cells, width): (usize, usize), is_in: impl Fn(usize) -> bool) -> usize {
    // Side of the largest square that ends in each cell of the row before, and of this row.
    let mut before = vec![0; width + 1];
    let mut widest = 0;
    for row in 0..n_cells.checked_div(width).unwrap_or(0) {
        let mut here = vec![0; width + 1];
        for x in 0..width {
            if is_in(row * width + x) {
                here[x + 1] = 1 + before[x].min(before[x + 1]).min(here[x]);
                widest = widest.max(here[x + 1]);
            }
        }
        before = here;
    }
    widest
}
