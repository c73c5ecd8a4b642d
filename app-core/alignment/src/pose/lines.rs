//! Locates the outline along lines across it, from the log odds of each pixel, for a pose that is
//! many pixels off.
//!
//! Source: correspondence lines of Stoiber et al. 2020 and 2022 (RBGT, SRT3D), which use mean and
//! variance of a distribution of the place along each line. They move a step function along the
//! line; here the toy's own coverage is moved, so that thin limbs fit as well as a body.

use super::contour::Element;
use super::motion::Measured;
use super::odds::Odds;
use crate::raster::Coverage;

/// Weight of a pixel's odds, since neighbours are correlated.
const INDEPENDENCE: f64 = 0.35;
/// Variance relative to a line without information, above which a line is skipped.
const MOST_VARIANCE: f64 = 0.7;

/// Measures the displacement of each piece, within `reach_px` in both directions.
pub(super) fn measure(
    elements: &[Element],
    coverage: &Coverage,
    odds: &Odds,
    reach_px: i32,
) -> Vec<Measured> {
    let along = elements
        .iter()
        .filter_map(|element| along(element, coverage, odds, reach_px));
    along.collect()
}

fn along(element: &Element, coverage: &Coverage, odds: &Odds, reach_px: i32) -> Option<Measured> {
    let pixels = |reach_px: i32| (-reach_px..=reach_px).map(|step| element.pixel(f64::from(step)));
    let model: Vec<f64> = pixels(3 * reach_px)
        .map(|at| f64::from(coverage.at(at)))
        .collect();
    let seen: Vec<f64> = pixels(2 * reach_px)
        .map(|at| INDEPENDENCE * f64::from(odds.at(at)))
        .collect();
    let log_odds = |shift: i32| -> f64 {
        let model = &model[(reach_px - shift) as usize..];
        let pairs = seen.iter().zip(model);
        pairs.map(|(odds, covered)| odds * (covered - 0.5)).sum()
    };
    let shifts: Vec<(f64, f64)> = (-reach_px..=reach_px)
        .map(|shift| (f64::from(shift), log_odds(shift)))
        .collect();
    let best = shifts
        .iter()
        .fold(f64::NEG_INFINITY, |best, (_, log)| best.max(*log));
    // At least 1, the term of the best shift.
    let total: f64 = shifts.iter().map(|(_, log)| (log - best).exp()).sum();
    let mean_of = |value: &dyn Fn(f64) -> f64| -> f64 {
        let weighted = shifts
            .iter()
            .map(|(shift, log)| (log - best).exp() * value(*shift));
        weighted.sum::<f64>() / total
    };
    let offset_px = mean_of(&|shift| shift);
    let variance = mean_of(&|shift| (shift - offset_px).powi(2));
    let uniform = f64::from(2 * reach_px + 1).powi(2) / 12.0;
    (variance < MOST_VARIANCE * uniform).then_some(Measured {
        element: *element,
        offset_px,
        // The resolution is limited by the pixel's size.
        precision: 1.0 / (variance + 1.0),
        robust: 1.0,
    })
}
