//! The camera for the app: the app's commands to the tracker, and the tracker's reports to the app.

use std::time::Duration;

use app_core::app::{ArSession, ShellEvent};
use glam::DMat4;

use super::ffi::Functions;
use super::frame::FrameError;
use super::status::{Failure, event_of};
use super::tracker::{Geometry, Run, Step, Tracker, Wait};
use crate::java::JavaHost;

/// Time after which a camera that another app uses is requested again.
const LOOK: Duration = Duration::from_secs(2);
/// Number of starts for which a limit on the camera's pictures is kept: the start after them tries
/// larger ones again.
const N_STARTS: u32 = 8;

/// A limit on the camera's pictures, as it is kept for later starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Limit {
    /// Width and height.
    size_px: [i32; 2],
    /// Number of later starts for which it is valid.
    n_starts: u32,
}

impl Limit {
    /// Reads a limit; `None` if the text contains none.
    fn read(text: &str) -> Option<Self> {
        let (size, n_starts) = text.trim().split_once(' ')?;
        let (width, height) = size.split_once('x')?;
        let size_px = [width.parse().ok()?, height.parse().ok()?];
        Some(Self {
            size_px,
            n_starts: n_starts.parse().ok()?,
        })
        .filter(|limit| limit.n_starts > 0 && limit.size_px.iter().all(|side| *side > 0))
    }

    fn text(self) -> String {
        let [width, height] = self.size_px;
        format!("{width}x{height} {}", self.n_starts)
    }
}

/// A tracker, if ARCore's library exists.
pub struct Feed {
    tracker: Option<Tracker>,
    /// The app's latest request.
    asked: Option<Run>,
    /// The event that the app waits for, until frames can arrive.
    waiting: Option<Wait>,
    /// Whether another app uses the camera, and the time of the last attempt to get it; the inner
    /// value is `None` before the first.
    interrupted: Option<Option<Duration>>,
    /// Whether the app waits for a camera that another app uses.
    is_wanted: bool,
    /// Limit left by an earlier start, for the starts after this one.
    limit: Option<Limit>,
    /// Limit as it was last reported for storage.
    kept: Option<Limit>,
    /// Whether the refusal of the card was reported.
    said_no_card: bool,
}

impl Feed {
    /// A feed before its first request.
    #[must_use]
    pub fn new(api: Option<Functions>) -> Self {
        Self {
            tracker: api.map(Tracker::new),
            asked: None,
            waiting: None,
            interrupted: None,
            is_wanted: true,
            limit: None,
            kept: None,
            said_no_card: false,
        }
    }

    /// Restores the result of [`Feed::take_kept`] from an earlier start. An invalid text counts as
    /// empty.
    #[must_use]
    pub fn with_kept(mut self, kept: &str) -> Self {
        if let (Some(limit), Some(tracker)) = (Limit::read(kept), &mut self.tracker) {
            tracker.limit(limit.size_px);
            self.kept = Some(limit);
            self.limit = Some(Limit {
                n_starts: limit.n_starts - 1,
                ..limit
            });
        }
        self
    }

    /// Text to be stored for later starts, if it has changed: the size of the delivered pictures,
    /// and the number of starts.
    #[must_use]
    pub fn take_kept(&mut self) -> Option<String> {
        let limited = self.tracker.as_ref().and_then(Tracker::limited_to);
        let limit = limited.map(|size_px| match self.limit {
            Some(limit) if limit.size_px == size_px => limit,
            _ => Limit {
                size_px,
                n_starts: N_STARTS,
            },
        });
        (std::mem::replace(&mut self.kept, limit) != limit).then(|| limit.map_or(String::new(), Limit::text))
    }

    /// The event for the app when it starts, and when it comes to the foreground.
    pub fn come_back(&mut self) -> Option<ShellEvent> {
        if self.tracker.is_none() {
            return Some(without_library());
        }
        // The other app may have released the camera.
        self.interrupted.take().map(|_| able())
    }

    /// Requests frames; returns the app's event if there will be none.
    pub fn run(&mut self, phone: &mut dyn JavaHost, run: Run) -> Option<ShellEvent> {
        self.asked = Some(run);
        self.interrupted = None;
        let was_waiting = self.waiting.take();
        let Some(tracker) = &mut self.tracker else {
            return Some(without_library());
        };
        match tracker.run(phone, run) {
            Step::Ready => was_waiting.map(|_| able()),
            Step::Waiting(wait) => {
                self.waiting = Some(wait);
                let is_news = was_waiting != Some(wait);
                is_news.then(|| ShellEvent::ArTrouble(ArSession::Installing, wait.words().into()))
            }
            Step::Refused(failure) => Some(self.fail(failure)),
        }
    }

    /// Ends the request for frames.
    pub fn pause(&mut self) {
        self.asked = None;
        if let Some(tracker) = &mut self.tracker {
            tracker.pause();
        }
    }

    /// Holds a place of the world. If it cannot be held, frames report none, and the app continues
    /// without it.
    pub fn hold(&mut self, id: u64, world_from_anchor: &DMat4) {
        let held = self
            .tracker
            .as_mut()
            .map(|tracker| tracker.hold(id, world_from_anchor));
        if let Some(Err(failure)) = held {
            eprintln!("arcore: no anchor: {failure}");
        }
    }

    /// Follows the display's rotation and size.
    pub fn set_display(&mut self, display: Geometry) {
        if let Some(tracker) = &mut self.tracker {
            tracker.set_display(display);
        }
    }

    /// Sets whether the app waits for a camera that another app uses; only then is it requested.
    pub fn set_wanted(&mut self, is_wanted: bool) {
        self.is_wanted = is_wanted;
    }

    /// The latest frame, if it is new, or the reason why there will be none. `now` is the time of a
    /// monotonic clock.
    pub fn poll(&mut self, phone: &mut dyn JavaHost, now: Duration) -> Option<ShellEvent> {
        if let Some(looked) = self.interrupted {
            return self
                .is_wanted
                .then(|| self.look_again(phone, now, looked))
                .flatten();
        }
        if let (Some(Wait::Answer), Some(run)) = (self.waiting, self.asked) {
            return self.run(phone, again(run));
        }
        let tracker = self.tracker.as_mut()?;
        let lacks_card = tracker.lacks_card();
        let had_said = std::mem::replace(&mut self.said_no_card, lacks_card);
        if lacks_card && !had_said {
            return Some(ShellEvent::CardRefused);
        }
        match tracker.update(now) {
            Ok(frame) => frame.map(|frame| ShellEvent::Frame(Box::new(frame))),
            Err(FrameError::Failed(failure)) => Some(self.fail(failure)),
            Err(error) => {
                eprintln!("arcore: no frame: {error}");
                let words = [
                    "The camera's pictures cannot be used. Close other apps, then start over.",
                    "Die Bilder der Kamera sind nicht brauchbar. Schließe andere Apps und beginne von vorn.",
                ];
                Some(ShellEvent::ArTrouble(ArSession::Failed, words.into()))
            }
        }
    }

    /// Requests the camera that another app had, and releases it again: the app requests it after
    /// that is reported.
    fn look_again(
        &mut self,
        phone: &mut dyn JavaHost,
        now: Duration,
        looked: Option<Duration>,
    ) -> Option<ShellEvent> {
        let is_due = looked.is_some_and(|looked| now.saturating_sub(looked) >= LOOK);
        if looked.is_none() || is_due {
            self.interrupted = Some(Some(now));
        }
        if !is_due {
            return None;
        }
        let run = Run {
            finds_planes: true,
            finds_card: false,
            is_new_world: false,
        };
        let tracker = self.tracker.as_mut()?;
        let step = tracker.run(phone, run);
        tracker.pause();
        match step {
            Step::Ready => {
                self.interrupted = None;
                Some(able())
            }
            Step::Refused(failure) => match self.fail(failure) {
                // The state is unchanged.
                ShellEvent::ArTrouble(ArSession::Interrupted, _) => {
                    self.interrupted = Some(Some(now));
                    None
                }
                other => {
                    self.interrupted = None;
                    Some(other)
                }
            },
            Step::Waiting(_) => None,
        }
    }

    fn fail(&mut self, failure: Failure) -> ShellEvent {
        eprintln!("arcore: no frames: {failure}");
        let event = event_of(failure);
        let is_interrupted = matches!(event, ShellEvent::ArTrouble(ArSession::Interrupted, _));
        self.interrupted = is_interrupted.then_some(None);
        event
    }
}

/// The event for a package without ARCore's library.
fn without_library() -> ShellEvent {
    let words = [
        "This package was made without ARCore, or with one of another version.",
        "Dieses Paket wurde ohne ARCore gebaut, oder mit einer anderen Version.",
    ];
    ShellEvent::ArTrouble(ArSession::Unsupported, words.into())
}

fn able() -> ShellEvent {
    ShellEvent::ArSession(ArSession::Able)
}

/// A started run continues in its world.
fn again(run: Run) -> Run {
    Run {
        is_new_world: false,
        ..run
    }
}
