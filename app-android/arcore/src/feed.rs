//! The camera as the app asks for it: its commands to the tracker, and what it is told of the tracker.

use app_core::app::{ArSession, ShellEvent};
use glam::DMat4;

use super::ffi::Functions;
use super::frame::FrameError;
use super::status::{Failure, told};
use super::tracker::{Geometry, Run, Step, Tracker, Wait};
use crate::java::JavaHost;

/// A tracker, where ARCore's library is there.
pub struct Feed {
    tracker: Option<Tracker>,
    /// What is tried again while ARCore is being looked for.
    waiting: Option<Run>,
    is_interrupted: bool,
}

impl Feed {
    /// A feed that was not asked for anything yet.
    #[must_use]
    pub fn new(api: Option<Functions>) -> Self {
        Self {
            tracker: api.map(Tracker::new),
            waiting: None,
            is_interrupted: false,
        }
    }

    /// What the app is told when it starts, and when it comes to the front.
    pub fn come_back(&mut self) -> Option<ShellEvent> {
        if self.tracker.is_none() {
            return Some(ShellEvent::ArSession(ArSession::Unsupported));
        }
        // Whatever had the camera may have let it go.
        std::mem::take(&mut self.is_interrupted).then_some(ShellEvent::ArSession(ArSession::Able))
    }

    /// Asks for frames; what the app is told if there will be none.
    pub fn run(&mut self, phone: &mut dyn JavaHost, run: Run) -> Option<ShellEvent> {
        self.waiting = None;
        match self.tracker.as_mut()?.run(phone, run) {
            Step::Ready | Step::Waiting(Wait::Install) => None,
            Step::Waiting(Wait::Answer) => {
                self.waiting = Some(run);
                None
            }
            Step::Refused(failure) => Some(self.fail(failure)),
        }
    }

    /// Asks for no more.
    pub fn pause(&mut self) {
        self.waiting = None;
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

    /// The latest frame, if it is new, or why there will be none.
    pub fn poll(&mut self, phone: &mut dyn JavaHost) -> Option<ShellEvent> {
        if let Some(run) = self.waiting {
            return self.run(phone, run);
        }
        match self.tracker.as_mut()?.update() {
            Ok(frame) => frame.map(|frame| ShellEvent::Frame(Box::new(frame))),
            Err(FrameError::Failed(failure)) => Some(self.fail(failure)),
            Err(error) => {
                eprintln!("arcore: no frame: {error}");
                Some(ShellEvent::ArSession(ArSession::Failed))
            }
        }
    }

    fn fail(&mut self, failure: Failure) -> ShellEvent {
        eprintln!("arcore: no frames: {failure}");
        let event = told(failure);
        self.is_interrupted = matches!(event, ShellEvent::ArSession(ArSession::Interrupted));
        event
    }
}
