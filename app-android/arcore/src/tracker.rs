//! From a phone without ARCore to a tracked frame: the requests, their order, and the consequence
//! of each refusal.
//!
//! | after `run` | next |
//! | --- | --- |
//! | [`Step::Ready`] | `update` |
//! | [`Step::Waiting`] for an answer about ARCore | `run` again, in a moment |
//! | [`Step::Waiting`] for an installation | Android's own screen is in front: `pause`, then `run` |
//! | [`Step::Refused`] | `run`, when the person tries again |
//!
//! The camera's permission is the app's concern: it requests frames only if the permission was
//! given.

use std::time::Duration;

use app_core::camera_frame::{CameraFrame, Stamp};
use glam::DMat4;

use super::ffi::Functions;
use super::frame::FrameError;
use super::session::{Finds, Session};
use super::status::{Availability, Failure, InEachLanguage, availability};
use crate::java::{Java, JavaHost};

/// `AR_INSTALL_STATUS_INSTALLED`.
const INSTALLED: i32 = 0;
/// `AR_UNAVAILABLE_DEVICE_NOT_COMPATIBLE`.
const NOT_COMPATIBLE: Failure = Failure(-101);
/// `AR_ERROR_FATAL`.
const FATAL: Failure = Failure(-2);

/// A request for frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Whether horizontal planes are detected.
    pub finds_planes: bool,
    /// Whether the printed card is detected, for which ARCore needs more time with each picture.
    pub finds_card: bool,
    /// Whether the world begins anew.
    pub is_new_world: bool,
}

/// Result of `run`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Frames can be requested.
    Ready,
    /// Another step comes first.
    Waiting(Wait),
    /// There will be no frames before the next `run`.
    Refused(Failure),
}

/// The event that is awaited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// The check for ARCore.
    Answer,
    /// The store's screen.
    Install,
}

/// The reasons why a session cannot begin.
enum Halt {
    Wait(Wait),
    Refused(Failure),
}

impl From<Failure> for Halt {
    fn from(failure: Failure) -> Self {
        Self::Refused(failure)
    }
}

/// The display's rotation and size, for ARCore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Geometry {
    /// `Surface.ROTATION_*`.
    pub quarter_turns: i32,
    /// Width and height, pixels.
    pub size_px: [i32; 2],
}

/// Time after which a camera that delivers no pictures is given up.
const PATIENCE: Duration = Duration::from_secs(3);
/// Minimum number of updates in that time: a loop that stood still has not really waited.
const N_LOOKS: u32 = 8;
/// Number of pictures after which autofocus, if requested, must have started.
const N_FOCUSED: u32 = 10;

/// The delivery of the requested pictures.
#[derive(Clone, Copy, Debug, Default)]
struct Watch {
    /// Time of the camera's start, or of the latest picture.
    since: Option<Duration>,
    /// Updates without a picture since then.
    n_looks: u32,
    /// Number of pictures since the start.
    n_pictures: u32,
    /// Whether the camera was restarted unchanged, and has not run well since.
    is_second_try: bool,
    /// Whether the camera was restarted for its focus, which happens once in a session.
    has_refocused: bool,
}

impl Watch {
    /// Records a start of the camera.
    fn begin(&mut self) {
        (self.since, self.n_looks, self.n_pictures) = (None, 0, 0);
    }
}

/// Owns a session and reads its frames.
pub struct Tracker {
    api: Functions,
    /// Dropped with the tracker, while the library of `api` is still loaded.
    session: Option<Session>,
    is_running: bool,
    has_asked_for_install: bool,
    display: Option<Geometry>,
    watch: Watch,
    /// Limit on the pictures' size, since larger ones were not delivered.
    at_most_px: Option<[i32; 2]>,
    /// The same once such pictures have arrived.
    limited_px: Option<[i32; 2]>,
    latest_ns: i64,
    n_frames: u64,
    /// Number of sessions; each has a world of its own.
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
            watch: Watch::default(),
            at_most_px: None,
            limited_px: None,
            latest_ns: 0,
            n_frames: 0,
            n_sessions: 0,
            n_missed: 0,
        }
    }

    /// Sets the limit of an earlier start: larger pictures are not delivered.
    pub fn limit(&mut self, at_most_px: [i32; 2]) {
        (self.at_most_px, self.limited_px) = (Some(at_most_px), Some(at_most_px));
    }

    /// Width and height of the delivered pictures if larger ones were not delivered, for later
    /// starts.
    #[must_use]
    pub fn limited_to(&self) -> Option<[i32; 2]> {
        self.limited_px
    }

    /// Number of frames whose pictures were missing when they were requested.
    #[must_use]
    pub fn n_missed(&self) -> u64 {
        self.n_missed
    }

    /// Advances towards frames as far as possible.
    pub fn run(&mut self, phone: &mut dyn JavaHost, run: Run) -> Step {
        if run.is_new_world {
            self.pause();
            self.session = None;
            // The person starts over, and may now accept an installation that was declined.
            self.has_asked_for_install = false;
        }
        let finds = Finds {
            planes: run.finds_planes,
            card: run.finds_card,
        };
        match self.begin(phone, finds) {
            Ok(()) => Step::Ready,
            Err(Halt::Wait(wait)) => Step::Waiting(wait),
            Err(Halt::Refused(failure)) => Step::Refused(failure),
        }
    }

    /// Holds a place of the world instead of the previous one.
    ///
    /// # Errors
    /// If ARCore refuses: then none is held.
    pub fn hold(&mut self, id: u64, world_from_anchor: &DMat4) -> Result<(), Failure> {
        match &mut self.session {
            Some(session) => session.hold(id, world_from_anchor),
            None => Ok(()),
        }
    }

    /// Whether the card is requested and ARCore refuses it.
    #[must_use]
    pub fn lacks_card(&self) -> bool {
        self.session.as_ref().is_some_and(Session::lacks_card)
    }

    /// Releases the camera. The session stays.
    pub fn pause(&mut self) {
        let running = self.session.as_ref().filter(|_| self.is_running);
        if running.is_some_and(|session| session.pause().is_err()) {
            // A session that cannot be paused cannot be resumed.
            self.session = None;
        }
        self.is_running = false;
    }

    /// Follows the display's rotation and size.
    pub fn set_display(&mut self, display: Geometry) {
        if self.display != Some(display) {
            self.display = Some(display);
            self.tell_display();
        }
    }

    /// The camera's latest frame; `None` if there is none after the last, or if its picture is
    /// missing. `now` is the time of any monotonic clock: a camera that delivers no pictures is
    /// restarted, then set to smaller ones.
    ///
    /// # Errors
    /// The error of ARCore or of the frame. After a fatal failure the next `run` begins a new
    /// session.
    pub fn update(&mut self, now: Duration) -> Result<Option<CameraFrame>, FrameError> {
        if !self.is_running {
            return Ok(None);
        }
        let frame = self.latest_frame()?;
        let since = *self.watch.since.get_or_insert(now);
        if frame.is_some() {
            (self.watch.since, self.watch.n_looks) = (Some(now), 0);
            self.watch.n_pictures = self.watch.n_pictures.saturating_add(1);
            self.picture_came()?;
            return Ok(frame);
        }
        self.watch.n_looks = self.watch.n_looks.saturating_add(1);
        if now.saturating_sub(since) >= PATIENCE && self.watch.n_looks >= N_LOOKS {
            self.begin_smaller()?;
        }
        Ok(frame)
    }

    fn picture_came(&mut self) -> Result<(), FrameError> {
        let Some(session) = &self.session else {
            return Ok(());
        };
        if self.watch.n_pictures == 1 && self.at_most_px.is_some() {
            self.limited_px = self.at_most_px;
        }
        if self.watch.n_pictures >= N_FOCUSED {
            self.watch.is_second_try = false;
        }
        if self.watch.n_pictures == N_FOCUSED && !self.watch.has_refocused && session.is_focus_stuck() {
            eprintln!("arcore: the camera has no autofocus: paused and resumed");
            self.watch.has_refocused = true;
            self.begin_anew(|_| Ok(true))?;
        }
        Ok(())
    }

    /// Restarts a camera that has delivered no picture for too long: once unchanged, since a start
    /// can be slow, then with the next mode.
    fn begin_smaller(&mut self) -> Result<(), FrameError> {
        if !std::mem::replace(&mut self.watch.is_second_try, true) {
            eprintln!("arcore: the camera delivers no pictures: restarted");
            return self.begin_anew(|_| Ok(true)).map(drop);
        }
        if self.begin_anew(Session::next_mode)? {
            self.at_most_px = self.session.as_ref().and_then(Session::mode_px);
            eprintln!(
                "arcore: no picture comes: smaller ones are asked for, {:?} px",
                self.at_most_px
            );
            return Ok(());
        }
        // Smaller pictures are not delivered either: a later session may begin with the largest.
        (self.at_most_px, self.limited_px) = (None, None);
        self.session = None;
        self.is_running = false;
        Err(FrameError::NoPictures)
    }

    /// Pauses the session, changes it, and resumes it if it was changed.
    fn begin_anew(
        &mut self,
        change: impl FnOnce(&mut Session) -> Result<bool, Failure>,
    ) -> Result<bool, FrameError> {
        let Some(session) = &mut self.session else {
            return Ok(false);
        };
        let begun = session
            .pause()
            .and_then(|()| change(session))
            .and_then(|is_changed| {
                if is_changed {
                    session.resume()?;
                }
                Ok(is_changed)
            });
        self.watch.begin();
        if begun.is_err() {
            self.session = None;
            self.is_running = false;
        }
        Ok(begun?)
    }

    fn latest_frame(&mut self) -> Result<Option<CameraFrame>, FrameError> {
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

    fn begin(&mut self, phone: &mut dyn JavaHost, finds: Finds) -> Result<(), Halt> {
        match &mut self.session {
            Some(session) => session.find(finds)?,
            None => {
                self.ensure_installed(phone.java())?;
                let session = Session::create(self.api, phone.java(), finds, self.at_most_px)?;
                self.session = Some(session);
                self.watch = Watch::default();
                self.n_sessions += 1;
                self.latest_ns = 0;
                self.tell_display();
            }
        }
        if let Some(session) = self.session.as_ref().filter(|_| !self.is_running) {
            session.resume()?;
            self.watch.begin();
            self.watch.is_second_try = false;
        }
        self.is_running = true;
        Ok(())
    }

    fn ensure_installed(&mut self, Java { env, activity }: Java) -> Result<(), Halt> {
        let mut answer = 0;
        // SAFETY: both pointers are valid now, and the result is a variable of ours.
        unsafe { (self.api.ArCoreApk_checkAvailability)(env, activity, &raw mut answer) };
        match availability(answer) {
            Availability::Installed => return Ok(()),
            Availability::Checking => return Err(Halt::Wait(Wait::Answer)),
            Availability::NotCapable => return Err(NOT_COMPATIBLE.into()),
            Availability::ToInstall | Availability::Unknown => {}
        }
        // A person who has declined is asked again only on starting over.
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

impl Wait {
    /// Text for the person.
    #[must_use]
    pub fn words(self) -> InEachLanguage {
        match self {
            Self::Answer => [
                "Looking for Google Play Services for AR.",
                "Google Play-Dienste für AR werden gesucht.",
            ],
            Self::Install => [
                "Google Play Services for AR is being installed.",
                "Google Play-Dienste für AR werden installiert.",
            ],
        }
    }
}
