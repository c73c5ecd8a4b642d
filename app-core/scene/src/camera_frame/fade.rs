//! The strength of the whole effect: it fades out while its inputs are unknown, and fades in again.

/// Duration of the fade-out: a false shadow is noticed at once.
const OUT_S: f64 = 0.15;
/// Duration of the fade-in.
const IN_S: f64 = 0.4;

/// The fade between the camera's picture and the whole result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fade {
    /// From 0 to 1, linear in time.
    way: f64,
}

impl Fade {
    /// Advances by `elapsed_s` seconds, if positive, towards the whole effect if its inputs are
    /// known (`is_known`), else towards none.
    pub fn step(&mut self, elapsed_s: f64, is_known: bool) {
        let elapsed_s = elapsed_s.max(0.0);
        let change = if is_known {
            elapsed_s / IN_S
        } else {
            -elapsed_s / OUT_S
        };
        self.way = (self.way + change).clamp(0.0, 1.0);
    }

    /// Share of the effect, from 0 to 1, smooth at both ends: for
    /// [`FrameInput::effect`](crate::frame::FrameInput).
    #[must_use]
    pub fn effect(&self) -> f64 {
        self.way * self.way * (3.0 - 2.0 * self.way)
    }
}
