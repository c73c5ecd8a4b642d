//! The middle one of some numbers.

use std::cmp::Ordering;

/// In an order that holds for all of them, such as [`f32::total_cmp`]; the larger of two in the middle, none of no numbers.
pub(crate) fn median<T: Copy>(
    numbers: impl IntoIterator<Item = T>,
    order: fn(&T, &T) -> Ordering,
) -> Option<T> {
    let mut numbers: Vec<T> = numbers.into_iter().collect();
    let middle = numbers.len() / 2;
    (!numbers.is_empty()).then(|| *numbers.select_nth_unstable_by(middle, order).1)
}
