//! Panics in a shell's callbacks: the app begins anew, but not for ever.

/// After so many within a time nothing begins anew: it would end the same way.
const MOST: usize = 3;
const WITHIN_S: f64 = 60.0;

/// When the latest came.
#[derive(Clone, Debug, Default)]
pub struct Panics {
    times_s: Vec<f64>,
}

impl Panics {
    /// One more, at a time of the shell's clock in seconds: whether a new app takes the place of the one that it left half
    /// changed. That one is told of it as [`Restarted`](super::ShellEvent::Restarted).
    pub fn begins_anew(&mut self, time_s: f64) -> bool {
        self.times_s.retain(|before_s| time_s - before_s < WITHIN_S);
        self.times_s.push(time_s);
        self.times_s.len() < MOST
    }
}
