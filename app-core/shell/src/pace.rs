//! When the loop draws: a picture for each of the camera's and for each touch, never more often than the screen is to show, and never by
//! turning round and round.
//!
//! It has no clock of its own: whoever calls tells the time.

use std::time::Duration;

/// Part of a picture's time that is slept; the rest is waited for by the display itself, whose clock is another one.
const SLEPT: f64 = 0.75;
/// A camera from which nothing has come for so long does not set the pace.
const CAMERA_LASTS: Duration = Duration::from_millis(200);
/// Time between its pictures. After one, the loop sleeps for most of it, then looks for the next by short steps.
const CAMERA_STEP: Duration = Duration::from_nanos(1_000_000_000 / 30);
/// While it does, what moves by itself is drawn so often at least.
const IDLE: Duration = Duration::from_millis(100);

/// When the next picture is due.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    frames_per_s: u32,
    drawn: Option<Duration>,
    camera: Option<Duration>,
    is_news: bool,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            frames_per_s: 60,
            drawn: None,
            camera: None,
            is_news: false,
        }
    }
}

impl Pace {
    /// So many pictures a second at most.
    pub fn set_rate(&mut self, frames_per_s: u32) {
        self.frames_per_s = frames_per_s.clamp(1, 240);
    }

    /// A picture of the camera has come.
    pub fn camera_came(&mut self, now: Duration) {
        self.camera = Some(now);
        self.is_news = true;
    }

    /// A finger has moved, or a window has come.
    pub fn touched(&mut self) {
        self.is_news = true;
    }

    /// For how long the loop may sleep before it looks at the camera again: until the next picture may be drawn.
    #[must_use]
    pub fn sleep(&self, now: Duration) -> Duration {
        let step = self.step();
        let due = self.drawn.map_or(now, |drawn| drawn + step);
        match self.camera.filter(|_| !self.is_news && self.is_led(now)) {
            Some(camera) => {
                let due = due.max(camera + CAMERA_STEP.mul_f64(SLEPT));
                due.saturating_sub(now).max(CAMERA_STEP / 8)
            }
            // Looked at and nothing there: a quarter of a picture's time later.
            None => due.saturating_sub(now).max(step / 4),
        }
    }

    fn step(&self) -> Duration {
        Duration::from_secs_f64(SLEPT / f64::from(self.frames_per_s))
    }

    /// Whether the camera sets the pace.
    fn is_led(&self, now: Duration) -> bool {
        self.camera
            .is_some_and(|camera| now.saturating_sub(camera) < CAMERA_LASTS)
    }

    /// Whether a picture is drawn now.
    #[must_use]
    pub fn is_due(&self, now: Duration) -> bool {
        let Some(drawn) = self.drawn else { return true };
        let least = if self.is_news || !self.is_led(now) {
            self.step()
        } else {
            IDLE
        };
        now.saturating_sub(drawn) >= least
    }

    /// One is drawn, from `now` on.
    pub fn draw(&mut self, now: Duration) {
        self.drawn = Some(now);
        self.is_news = false;
    }
}
