//! The median, and ranks.

use std::cmp::Ordering;

/// Standard deviation of a normal distribution over its median absolute deviation.
pub(crate) const DEVIATION_OF_MEDIAN: f64 = 1.4826;
/// The same for light.
#[allow(clippy::cast_possible_truncation, reason = "a constant, to 7 digits")]
pub(crate) const DEVIATION_OF_MEDIAN_32: f32 = DEVIATION_OF_MEDIAN as f32;

/// The median of a list, with a total order such as [`f32::total_cmp`]; the larger of two central
/// values, `None` for an empty list.
pub(crate) fn median<T: Copy>(
    numbers: impl IntoIterator<Item = T>,
    order: fn(&T, &T) -> Ordering,
) -> Option<T> {
    let mut numbers: Vec<T> = numbers.into_iter().collect();
    let middle = numbers.len() / 2;
    (!numbers.is_empty()).then(|| *numbers.select_nth_unstable_by(middle, order).1)
}

/// A part of a count, rounded down: a rank.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a part of a count"
)]
pub(crate) fn part_of(n: usize, part: f64) -> usize {
    (part * n as f64) as usize
}
