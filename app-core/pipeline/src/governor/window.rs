//! Sliding window over the last N samples.

use std::collections::VecDeque;

/// Sliding window over the last `size` samples.
#[derive(Clone, Debug)]
pub(super) struct Window {
    size: usize,
    numbers: VecDeque<f64>,
}

impl Window {
    pub(super) fn new(size: usize) -> Self {
        Self {
            size,
            numbers: VecDeque::with_capacity(size),
        }
    }

    pub(super) fn push(&mut self, number: f64) {
        if self.numbers.len() == self.size {
            self.numbers.pop_front();
        }
        self.numbers.push_back(number);
    }

    pub(super) fn clear(&mut self) {
        self.numbers.clear();
    }

    /// Median; `None` until the window is full.
    pub(super) fn median(&self) -> Option<f64> {
        let mut sorted: Vec<f64> = self.full()?.collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied()
    }

    /// Mean; `None` until the window is full.
    pub(super) fn mean(&self) -> Option<f64> {
        let n = self.size as f64;
        Some(self.full()?.sum::<f64>() / n)
    }

    fn full(&self) -> Option<impl Iterator<Item = f64>> {
        (self.numbers.len() == self.size && self.size > 0).then(|| self.numbers.iter().copied())
    }
}
