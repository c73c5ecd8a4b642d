//! Panics in a shell's callbacks: the app is restarted, but not without limit.

/// Number of panics within a time after which the app is not restarted, since it would end in the
/// same way.
const MOST: usize = 3;
const WITHIN_S: f64 = 60.0;

/// Times of the latest panics.
#[derive(Clone, Debug, Default)]
pub struct Panics {
    times_s: Vec<f64>,
}

impl Panics {
    /// Records a panic at a time of the shell's clock in seconds; returns whether a new app
    /// replaces the broken one. The new app gets [`Restarted`](super::ShellEvent::Restarted).
    pub fn begins_anew(&mut self, time_s: f64) -> bool {
        self.times_s.retain(|before_s| time_s - before_s < WITHIN_S);
        self.times_s.push(time_s);
        self.times_s.len() < MOST
    }
}
