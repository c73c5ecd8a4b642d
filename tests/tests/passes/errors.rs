//! Differences between two lists of numbers.

use glam::{DVec3, DVec4};
use reference::raster::Raster;

/// All channels of two pictures of a size.
pub(crate) fn pairs_of(actual: &Raster<DVec4>, expected: &Raster<DVec4>) -> Vec<(f64, f64)> {
    let both = actual.texels().iter().zip(expected.texels());
    both.flat_map(|(actual, expected)| (0..4).map(|k| (actual[k], expected[k])))
        .collect()
}

/// The channels of two colours.
pub(crate) fn channels(actual: DVec3, expected: DVec3) -> impl Iterator<Item = (f64, f64)> {
    (0..3).map(move |channel| (actual[channel], expected[channel]))
}

/// Differences between the device's results and the reference.
pub(crate) struct Errors {
    sorted: Vec<f64>,
}

impl Errors {
    /// Differences of pairs (actual, expected). A pair with a number that is not finite has an
    /// infinite difference.
    pub(crate) fn between(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let difference = |(actual, expected): (f64, f64)| {
            let difference = (actual - expected).abs();
            if difference.is_finite() {
                difference
            } else {
                f64::INFINITY
            }
        };
        let mut sorted: Vec<f64> = pairs.into_iter().map(difference).collect();
        assert!(!sorted.is_empty(), "nothing was compared");
        sorted.sort_by(f64::total_cmp);
        Self { sorted }
    }

    pub(crate) fn max(&self) -> f64 {
        self.sorted.last().copied().unwrap_or(f64::INFINITY)
    }

    pub(crate) fn mean(&self) -> f64 {
        let n = f64::from(u32::try_from(self.sorted.len()).unwrap());
        self.sorted.iter().sum::<f64>() / n
    }

    /// Share of differences larger than `bound`.
    pub(crate) fn share_beyond(&self, bound: f64) -> f64 {
        let n_within = self.sorted.partition_point(|difference| *difference <= bound);
        let count = |n: usize| f64::from(u32::try_from(n).unwrap());
        count(self.sorted.len() - n_within) / count(self.sorted.len())
    }

    /// Fails unless all are within `max`; prints the measured values.
    pub(crate) fn check_all(&self, what: &str, max: f64) {
        self.check(what, (max, 0.0), max);
    }

    /// Fails unless at most `max_share` are beyond `bound`, and none beyond `max`; prints the
    /// measured values.
    pub(crate) fn check(&self, what: &str, (bound, max_share): (f64, f64), max: f64) {
        let (share, worst) = (self.share_beyond(bound), self.max());
        let measured = format!(
            "{what}: {:.3} % of {} beyond {bound:.2e}, worst {worst:.2e}",
            100.0 * share,
            self.sorted.len()
        );
        eprintln!("{measured}");
        assert!(
            share <= max_share && worst <= max,
            "{measured}; allowed {:.3} %, {max:.2e}",
            100.0 * max_share
        );
    }
}

#[test]
fn a_number_that_is_not_finite_is_the_largest_error() {
    for pair in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, f64::INFINITY)] {
        let errors = Errors::between([(0.0, 0.0), pair]);
        assert!(
            errors.max().is_infinite() && errors.share_beyond(1e9) == 0.5,
            "{pair:?}"
        );
    }
}
