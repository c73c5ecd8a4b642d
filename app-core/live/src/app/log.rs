//! The log for an export: only the latest lines.

use std::collections::VecDeque;
use std::fmt::Write;

/// Number of kept lines.
const N_LINES: usize = 512;

/// A ring of lines.
#[derive(Clone, Debug, Default)]
pub struct Log {
    lines: VecDeque<String>,
    n_dropped: u64,
}

impl Log {
    /// Stores a line with its time, in seconds since the first frame.
    pub(super) fn line(&mut self, time_s: f64, what: &dyn std::fmt::Debug) {
        if self.lines.len() == N_LINES {
            self.lines.pop_front();
            self.n_dropped += 1;
        }
        self.lines.push_back(format!("{time_s:10.3} {what:?}"));
    }

    /// Number of lines written so far.
    #[must_use]
    pub fn n_lines(&self) -> u64 {
        self.n_dropped + self.lines.len() as u64
    }

    /// The whole log, the oldest line first.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        if self.n_dropped > 0 {
            let _ = writeln!(text, "{} earlier lines are not kept", self.n_dropped);
        }
        for line in &self.lines {
            let _ = writeln!(text, "{line}");
        }
        text
    }
}
