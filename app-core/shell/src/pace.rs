//! Timing of the drawing loop: a picture for each one of the camera's and for each touch, never
//! more often than the screen shows one, and without busy waiting.
//!
//! It has no clock of its own: the caller supplies the time.

use std::time::Duration;

/// Share of a picture's time that the loop sleeps; the display itself waits for the rest, since it
/// has another clock.
const SLEPT: f64 = 0.75;
/// Time without a picture after which a camera no longer sets the pace.
const CAMERA_LASTS: Duration = Duration::from_millis(200);
/// Time between the camera's pictures. After one, the loop sleeps for most of it, then polls in
/// short steps.
const CAMERA_STEP: Duration = Duration::from_nanos(1_000_000_000 / 30);
/// Largest time between pictures of moving content while the camera sets the pace.
const IDLE: Duration = Duration::from_millis(100);

/// The time of the next picture.
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
    /// Sets the maximum number of pictures a second.
    pub fn set_rate(&mut self, frames_per_s: u32) {
        self.frames_per_s = frames_per_s.clamp(1, 240);
    }

    /// A picture of the camera has arrived.
    pub fn camera_came(&mut self, now: Duration) {
        self.camera = Some(now);
        self.is_news = true;
    }

    /// A finger has moved, or a window was opened.
    pub fn touched(&mut self) {
        self.is_news = true;
    }

    /// Time for which the loop may sleep before it polls the camera again: until the next picture
    /// may be drawn.
    #[must_use]
    pub fn sleep(&self, now: Duration) -> Duration {
        let step = self.step();
        let due = self.drawn.map_or(now, |drawn| drawn + step);
        match self.camera.filter(|_| !self.is_news && self.is_led(now)) {
            Some(camera) => {
                let due = due.max(camera + CAMERA_STEP.mul_f64(SLEPT));
                due.saturating_sub(now).max(CAMERA_STEP / 8)
            }
            // Polled without a picture: a quarter of a picture's time later.
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

    /// A picture is drawn, from `now` on.
    pub fn draw(&mut self, now: Duration) {
        self.drawn = Some(now);
        self.is_news = false;
    }
}
