//! From a phone without ARCore to a tracked frame: what is asked for, in which order, and what each refusal leads to.
//!
//! | after `run` | what comes next |
//! | --- | --- |
//! | [`Step::Ready`] | `update` |
//! | [`Step::Waiting`] for an answer about ARCore | `run` again, in a moment |
//! | [`Step::Waiting`] for an install | Android's own screen is in front: `pause`, then `run` |
//! | [`Step::Refused`] | `run`, when the person tries again |
//!
//! The camera's permission is the app's concern: it asks for frames only where it was given.

use std::fmt;

use app_core::camera_frame::{CameraFrame, Stamp};
use glam::DMat4;

use super::ffi::Functions;
use super::frame::FrameError;
use super::session::Session;
use super::status::{Availability, Failure, availability};
use crate::java::{Java, JavaHost};

/// `AR_INSTALL_STATUS_INSTALLED`.
const INSTALLED: i32 = 0;
/// `AR_UNAVAILABLE_DEVICE_NOT_COMPATIBLE`.
const NOT_COMPATIBLE: Failure = Failure(-101);
/// `AR_ERROR_FATAL`.
const FATAL: Failure = Failure(-2);

/// How frames are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Whether level planes are looked for.
    pub finds_planes: bool,
    /// Whether the world begins anew.
    pub is_new_world: bool,
}

/// What `run` came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Frames can be asked for.
    Ready,
    /// Something else comes first.
    Waiting(Wait),
    /// There will be no frames before the next `run`.
    Refused(Failure),
}

/// What is waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// ARCore is being looked for.
    Answer,
    /// The store's screen.
    Install,
}

/// Either of what keeps a session from beginning.
enum Halt {
    Wait(Wait),
    Refused(Failure),
}

impl From<Failure> for Halt {
    fn from(failure: Failure) -> Self {
        Self::Refused(failure)
    }
}

/// How the display lies, as ARCore is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Geometry {
    /// `Surface.ROTATION_*`.
    pub quarter_turns: i32,
    /// Width and height, pixels.
    pub size_px: [i32; 2],
}

/// Keeps a session and reads its frames.
pub struct Tracker {
    api: Functions,
    /// Dropped with the tracker, while the library of `api` is still loaded.
    session: Option<Session>,
    is_running: bool,
    has_asked_for_install: bool,
    display: Option<Geometry>,
    latest_ns: i64,
    n_frames: u64,
    /// Each session has a world of its own.
    n_sessions: u32,
    n_missed: u64,
}

impl Tracker {
    /// A tracker without a session.
    #[must_use]
    pub fn new(api: Functions) -> Self {
        Self {
            api,
            session: None,
            is_running: false,
            has_asked_for_install: false,
            display: None,
            latest_ns: 0,
            n_frames: 0,
            n_sessions: 0,
            n_missed: 0,
        }
    }

    /// Frames whose pictures were not there when they were asked for.
    #[must_use]
    pub fn n_missed(&self) -> u64 {
        self.n_missed
    }

    /// Goes as far towards frames as it can.
    pub fn run(&mut self, phone: &mut dyn JavaHost, run: Run) -> Step {
        if run.is_new_world {
            self.pause();
            self.session = None;
            // The person starts over, and may think otherwise of what was declined.
            self.has_asked_for_install = false;
        }
        match self.begin(phone, run.finds_planes) {
            Ok(()) => Step::Ready,
            Err(Halt::Wait(wait)) => Step::Waiting(wait),
            Err(Halt::Refused(failure)) => Step::Refused(failure),
        }
    }

    /// Holds a place of the world, in place of the one before.
    ///
    /// # Errors
    /// Where ARCore refuses: then none is held.
    pub fn hold(&mut self, id: u64, world_from_anchor: &DMat4) -> Result<(), Failure> {
        match &mut self.session {
            Some(session) => session.hold(id, world_from_anchor),
            None => Ok(()),
        }
    }

    /// Lets the camera go. The session stays.
    pub fn pause(&mut self) {
        let running = self.session.as_ref().filter(|_| self.is_running);
        if running.is_some_and(|session| session.pause().is_err()) {
            // A session that cannot be paused cannot be resumed.
            self.session = None;
        }
        self.is_running = false;
    }

    /// Follows the display.
    pub fn set_display(&mut self, display: Geometry) {
        if self.display != Some(display) {
            self.display = Some(display);
            self.tell_display();
        }
    }

    /// The camera's latest frame; none if there is no later one than the last, or none whose picture is there.
    ///
    /// # Errors
    /// What ARCore or the frame says. After a fatal failure the next `run` begins a new session.
    pub fn update(&mut self) -> Result<Option<CameraFrame>, FrameError> {
        let Some(session) = self.session.as_ref().filter(|_| self.is_running) else {
            return Ok(None);
        };
        if let Err(failure) = session.update() {
            if failure == FATAL {
                self.session = None;
                self.is_running = false;
            }
            return Err(failure.into());
        }
        let time_ns = session.time_ns();
        // A frame before the first has time 0; an update without a new frame repeats the last one.
        if time_ns == 0 || time_ns == self.latest_ns {
            return Ok(None);
        }
        let frame = session.read(Stamp {
            id: self.n_frames + self.n_missed,
            time_ns,
            world_epoch: self.n_sessions,
        })?;
        match frame {
            Some(_) => {
                self.latest_ns = time_ns;
                self.n_frames += 1;
            }
            None => self.n_missed += 1,
        }
        Ok(frame)
    }

    fn begin(&mut self, phone: &mut dyn JavaHost, finds_planes: bool) -> Result<(), Halt> {
        match &mut self.session {
            Some(session) => session.find_planes(finds_planes)?,
            None => {
                self.ensure_installed(phone.java())?;
                self.session = Some(Session::create(self.api, phone.java(), finds_planes)?);
                self.n_sessions += 1;
                self.latest_ns = 0;
                self.tell_display();
            }
        }
        if let Some(session) = self.session.as_ref().filter(|_| !self.is_running) {
            session.resume()?;
        }
        self.is_running = true;
        Ok(())
    }

    fn ensure_installed(&mut self, Java { env, activity }: Java) -> Result<(), Halt> {
        let mut answer = 0;
        // SAFETY: both pointers are valid now, and the answer is a place of ours.
        unsafe { (self.api.ArCoreApk_checkAvailability)(env, activity, &raw mut answer) };
        match availability(answer) {
            Availability::Installed => return Ok(()),
            Availability::Checking => return Err(Halt::Wait(Wait::Answer)),
            Availability::NotCapable => return Err(NOT_COMPATIBLE.into()),
            Availability::ToInstall | Availability::Unknown => {}
        }
        // A person who has said no is asked again only on starting over.
        let is_first = i32::from(!self.has_asked_for_install);
        self.has_asked_for_install = true;
        let mut outcome = INSTALLED;
        // SAFETY: as above.
        Failure::check(unsafe {
            (self.api.ArCoreApk_requestInstall)(env, activity, is_first, &raw mut outcome)
        })?;
        if outcome == INSTALLED {
            Ok(())
        } else {
            Err(Halt::Wait(Wait::Install))
        }
    }

    fn tell_display(&self) {
        if let (Some(session), Some(display)) = (&self.session, self.display) {
            session.set_display(display.quarter_turns, display.size_px);
        }
    }
}

impl fmt::Display for Wait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Answer => "Looking for Google Play Services for AR.",
            Self::Install => "Google Play Services for AR is being installed.",
        })
    }
}
