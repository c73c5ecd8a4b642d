//! From a phone without ARCore to a tracked frame: what is asked for, in which order, and what each refusal leads to.
//!
//! | after `resume` | what the app does | what comes next |
//! | --- | --- | --- |
//! | [`Step::Ready`] | asks for frames | `update` |
//! | [`Step::Waiting`] for an answer about ARCore | shows that it looks | `resume` again, in a moment |
//! | [`Step::Waiting`] for an install or a permission | nothing: Android's own screen is in front | `pause`, then `resume` |
//! | [`Step::Refused`] | shows the message | `resume`, when the person comes back |

use std::fmt;

use super::ffi::Functions;
use super::frame::{FrameError, TrackedFrame};
use super::session::{Java, Session};
use super::status::{Availability, Failure, PERMISSION_NOT_GRANTED, Remedy, availability};

/// `AR_INSTALL_STATUS_INSTALLED`.
const INSTALLED: i32 = 0;
/// `AR_UNAVAILABLE_DEVICE_NOT_COMPATIBLE`.
const NOT_COMPATIBLE: Failure = Failure(-101);
/// `AR_ERROR_FATAL`.
const FATAL: Failure = Failure(-2);

/// What the tracker asks of the phone, beside ARCore.
pub trait Phone {
    /// The pointers that ARCore is called with, valid on this thread until the next call.
    fn java(&mut self) -> Java;
    /// Whether the app may use the camera.
    fn has_camera_permission(&mut self) -> bool;
    /// Shows Android's question. The activity pauses and resumes around it.
    fn ask_for_camera(&mut self);
}

/// What `resume` came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Frames can be asked for.
    Ready,
    /// Something else comes first.
    Waiting(Wait),
    /// There will be no frames before the next `resume`.
    Refused(Failure),
}

/// What is waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// ARCore is being looked for.
    Answer,
    /// The store's screen.
    Install,
    /// Android's question.
    Permission,
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

/// Follows the activity and keeps its session.
pub struct Tracker<P> {
    api: Functions,
    phone: P,
    /// Dropped with the tracker, while the library of `api` is still loaded.
    session: Option<Session>,
    is_running: bool,
    has_asked_for_install: bool,
    has_asked_for_camera: bool,
    display: Option<Geometry>,
    latest_ns: i64,
    n_missed: u64,
}

impl<P: Phone> Tracker<P> {
    /// A tracker without a session.
    pub fn new(api: Functions, phone: P) -> Self {
        Self {
            api,
            phone,
            session: None,
            is_running: false,
            has_asked_for_install: false,
            has_asked_for_camera: false,
            display: None,
            latest_ns: 0,
            n_missed: 0,
        }
    }

    /// Frames whose pictures were not there when they were asked for.
    #[must_use]
    pub fn n_missed(&self) -> u64 {
        self.n_missed
    }

    /// Goes as far as it can, when the activity comes to the front and while it waits for an answer.
    pub fn resume(&mut self) -> Step {
        if self.is_running {
            return Step::Ready;
        }
        match self.begin() {
            Ok(()) => Step::Ready,
            Err(Halt::Wait(wait)) => Step::Waiting(wait),
            Err(Halt::Refused(failure)) => Step::Refused(failure),
        }
    }

    /// Lets the camera go, when the activity leaves the front. The session stays.
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
    /// What ARCore or the frame says. After a fatal failure the next `resume` begins a new session.
    pub fn update(&mut self) -> Result<Option<TrackedFrame>, FrameError> {
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
        let frame = session.read()?;
        match frame {
            Some(_) => self.latest_ns = time_ns,
            None => self.n_missed += 1,
        }
        Ok(frame)
    }

    fn begin(&mut self) -> Result<(), Halt> {
        if self.session.is_none() {
            self.ensure_installed()?;
            self.ensure_permission()?;
            self.session = Some(Session::create(self.api, self.phone.java())?);
            self.latest_ns = 0;
            self.tell_display();
        } else {
            // It may have been taken away in the settings, while the app was in the background.
            self.ensure_permission()?;
        }
        if let Some(session) = &self.session {
            session.resume()?;
        }
        self.is_running = true;
        Ok(())
    }

    fn ensure_installed(&mut self) -> Result<(), Halt> {
        let Java { env, activity } = self.phone.java();
        let mut answer = 0;
        // SAFETY: both pointers are valid now, and the answer is a place of ours.
        unsafe { (self.api.ArCoreApk_checkAvailability)(env, activity, &raw mut answer) };
        match availability(answer) {
            Availability::Installed => return Ok(()),
            Availability::Checking => return Err(Halt::Wait(Wait::Answer)),
            Availability::NotCapable => return Err(NOT_COMPATIBLE.into()),
            Availability::ToInstall | Availability::Unknown => {}
        }
        // A person who has said no is asked again only at a new start.
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

    fn ensure_permission(&mut self) -> Result<(), Halt> {
        if self.phone.has_camera_permission() {
            self.has_asked_for_camera = false;
            return Ok(());
        }
        if self.has_asked_for_camera {
            return Err(Failure(PERMISSION_NOT_GRANTED).into());
        }
        self.has_asked_for_camera = true;
        self.phone.ask_for_camera();
        Err(Halt::Wait(Wait::Permission))
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
            Self::Permission => "The app sees your toy through the camera. Allow it.",
        })
    }
}

impl Step {
    /// What to tell, and what the person can do; none when ready.
    #[must_use]
    pub fn message(self) -> Option<(String, Option<Remedy>)> {
        match self {
            Self::Ready => None,
            Self::Waiting(wait) => Some((wait.to_string(), None)),
            Self::Refused(failure) => Some((failure.to_string(), Some(failure.remedy()))),
        }
    }
}
