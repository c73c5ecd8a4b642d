//! How far the effect is shown: it fades while what it needs is not known, and comes back.

/// Time in which the effect goes, from whole to nothing: a false shadow is seen at once.
const OUT_S: f64 = 0.15;
/// Time in which it comes.
const IN_S: f64 = 0.4;

/// The effect's way between the camera's picture and the whole result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fade {
    /// From 0 to 1, linear in time.
    way: f64,
}

impl Fade {
    /// Goes on by `elapsed_s` seconds, which count from 0, towards the whole effect where it `is_known` how to make it, else
    /// towards nothing.
    pub fn step(&mut self, elapsed_s: f64, is_known: bool) {
        let elapsed_s = elapsed_s.max(0.0);
        let change = if is_known {
            elapsed_s / IN_S
        } else {
            -elapsed_s / OUT_S
        };
        self.way = (self.way + change).clamp(0.0, 1.0);
    }

    /// Part of the effect, from 0 to 1, without a kink at either end: for [`FrameInput::effect`](crate::frame::FrameInput).
    #[must_use]
    pub fn effect(&self) -> f64 {
        self.way * self.way * (3.0 - 2.0 * self.way)
    }
}
