//! CPU reference of `fill.wgsl`: unknown cells from their neighbours, by pull-push.
//!
//! Source: Gortler et al. 1996, section 3.4.

use glam::{DVec3, DVec4, UVec2};

use super::grid::Cell;
use super::raster::Raster;

/// Levels of a pyramid, the finest included; the last may have a single cell: 64 cells halve six
/// times.
const N_LEVELS: u32 = 7;

/// Fills every cell according to its uncertainty.
#[must_use]
pub fn fill(cells: &Raster<Cell>) -> Raster<DVec3> {
    let finest = Raster::from_fn(cells.size(), |at| {
        let cell = cells.at(at);
        (cell.value * cell.certainty).extend(cell.certainty)
    });
    push(finest, N_LEVELS - 1).map(DVec4::truncate)
}

/// From values times certainties to the same with every certainty completed from the coarser level.
fn push(level: Raster<DVec4>, n_coarser: u32) -> Raster<DVec4> {
    if n_coarser == 0 {
        return level.map(|all| if all.w > 0.0 { all / all.w } else { all });
    }
    let coarse = push(pull(&level), n_coarser - 1);
    Raster::from_fn(level.size(), |at| {
        let own = level.at(at);
        own + (1.0 - own.w) * coarse.bilinear(0.5 * (at.as_dvec2() + 0.5))
    })
}

/// Half the size, rounded up: sums of four, in which four certain cells count as one.
fn pull(fine: &Raster<DVec4>) -> Raster<DVec4> {
    Raster::from_fn((fine.size() + 1) / 2, |at| {
        let children = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE].map(|corner| 2 * at + corner);
        let sum: DVec4 = children
            .into_iter()
            .filter(|child| child.cmplt(fine.size()).all())
            .map(|child| fine.at(child))
            .sum();
        sum / sum.w.max(1.0)
    })
}
