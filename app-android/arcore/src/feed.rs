//! The camera as the app asks for it: its commands to the tracker, and what it is told of the tracker.

use std::time::Duration;

use app_core::app::{ArSession, ShellEvent};
use glam::DMat4;

use super::ffi::Functions;
use super::frame::FrameError;
use super::status::{Failure, told};
use super::tracker::{Geometry, Run, Step, Tracker, Wait};
use crate::java::JavaHost;

/// Time after which a camera that something else has is asked for again.
const LOOK: Duration = Duration::from_secs(2);
/// Starts for which a limit of the camera's pictures is kept: one start after them tries larger ones again.
const N_STARTS: u32 = 8;

/// A limit of the camera's pictures, as it is kept for later starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Limit {
    /// Width and height.
    size_px: [i32; 2],
    /// Later starts that it is for.
    n_starts: u32,
}

impl Limit {
    /// That of a text; none where it says nothing.
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

/// A tracker, where ARCore's library is there.
pub struct Feed {
    tracker: Option<Tracker>,
    /// As the app asked last.
    asked: Option<Run>,
    /// What the app is waiting for, until frames can come.
    waiting: Option<Wait>,
    /// Something else has the camera, and when that was looked at; none before the first look.
    interrupted: Option<Option<Duration>>,
    /// Whether the app waits for a camera that something else has.
    is_wanted: bool,
    /// As an earlier start has left it, for the starts after this one.
    limit: Option<Limit>,
    /// As it was last said to be kept.
    kept: Option<Limit>,
    /// It was said that the card is refused.
    said_no_card: bool,
}

impl Feed {
    /// A feed that was not asked for anything yet.
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

    /// Takes what [`Feed::take_kept`] returned in an earlier start. A text that says nothing is as none.
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

    /// What is to be kept for later starts, if that has changed: the size of the pictures that come, and for how many starts.
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

    /// What the app is told when it starts, and when it comes to the front.
    pub fn come_back(&mut self) -> Option<ShellEvent> {
        if self.tracker.is_none() {
            return Some(without_library());
        }
        // Whatever had the camera may have let it go.
        self.interrupted.take().map(|_| able())
    }

    /// Asks for frames; what the app is told if there will be none.
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
                is_news.then(|| ShellEvent::ArTrouble(ArSession::Installing, wait.to_string()))
            }
            Step::Refused(failure) => Some(self.fail(failure)),
        }
    }

    /// Asks for no more.
    pub fn pause(&mut self) {
        self.asked = None;
        if let Some(tracker) = &mut self.tracker {
            tracker.pause();
        }
    }

    /// Holds a place of the world. Where it cannot be held, frames tell of none, and the app does without.
    pub fn hold(&mut self, id: u64, world_from_anchor: &DMat4) {
        let held = self
            .tracker
            .as_mut()
            .map(|tracker| tracker.hold(id, world_from_anchor));
        if let Some(Err(failure)) = held {
            eprintln!("arcore: no anchor: {failure}");
        }
    }

    /// Follows the display.
    pub fn set_display(&mut self, display: Geometry) {
        if let Some(tracker) = &mut self.tracker {
            tracker.set_display(display);
        }
    }

    /// Whether the app waits for a camera that something else has, which is left alone else.
    pub fn set_wanted(&mut self, is_wanted: bool) {
        self.is_wanted = is_wanted;
    }

    /// The latest frame, if it is new, or why there will be none. `now` is of a clock that goes on.
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
                let words = format!("{}. Close other apps, then start over.", sentence(&error));
                Some(ShellEvent::ArTrouble(ArSession::Failed, words))
            }
        }
    }

    /// Asks for the camera that something else had, and lets it go again: the app asks for it once that is reported.
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
                // As before.
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
        let event = told(failure);
        let is_interrupted = matches!(event, ShellEvent::ArTrouble(ArSession::Interrupted, _));
        self.interrupted = is_interrupted.then_some(None);
        event
    }
}

/// What is told of a package without ARCore's library.
fn without_library() -> ShellEvent {
    let words = "This package was made without ARCore, or with one of another version.";
    ShellEvent::ArTrouble(ArSession::Unsupported, words.to_owned())
}

fn able() -> ShellEvent {
    ShellEvent::ArSession(ArSession::Able)
}

/// A run that was begun goes on in its world.
fn again(run: Run) -> Run {
    Run {
        is_new_world: false,
        ..run
    }
}

/// With a capital letter.
fn sentence(error: &FrameError) -> String {
    let words = error.to_string();
    let mut letters = words.chars();
    let first = letters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}
