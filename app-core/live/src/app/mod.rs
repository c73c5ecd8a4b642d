//! The app's logic, common to both phones' shells and the desktop, from the first button to the
//! moving toy.
//!
//! A shell reports events ([`ShellEvent`]) and executes commands ([`ShellCommand`]); it decides
//! nothing. There is no clock, no file, no device and no thread here: time comes with the frames,
//! and an alignment, which takes a second, is a job that the shell runs on any thread. So every
//! order of events can be tested on a desktop.

mod actions;
mod aligning;
mod event;
mod frames;
mod ghost;
mod ghost_shape;
mod language;
mod launch_history;
mod lens;
mod log;
mod notice;
mod panics;
mod phone_check;
mod placing;
mod plates;
mod platform;
mod playback;
mod recorder;
mod recordings;
mod reticle;
mod search;
mod show;
mod start;
mod step;
mod table;
mod toy_refusal;
mod toys;
mod watching;

use std::sync::Arc;

use glam::DVec3;

use app_scene::camera_frame::{Arrivals, CameraFrame, Fade, FoundPlane};
use app_scene::scene::{Camera, Plate};
use app_scene::toy::Toy;

use aligning::Place;
use ghost::Ghost;
use ghost_shape::GhostShape;
use lens::Lens;
use phone_check::PhoneCheck;
use plates::Plating;
use platform::{Asked, Captures, Commanded, Platform};
use recorder::Recorder;
use search::Search;
use start::Start;

pub use aligning::{AlignJob, AlignedJob, Verdict};
pub use app_alignment::plate_taker::{PlateRefusal, PlateShot, PlateStep, PlateTaker};
pub use app_alignment::pose_filter::{PoseFilter, PoseNoise, PoseStep};
pub use event::{
    ArSession, Filmed, GraphicsState, Permission, PlatformCommand, Recorded, Saved, ShellCommand, ShellEvent,
    Thermal, UserAction, VideoEnding, WorkCommand,
};
pub use language::{Language, Translated};
pub use launch_history::{LaunchHistory, MAX_FAILED_LAUNCHES, N_GOOD_FRAMES, Simplified};
pub use log::Log;
pub use notice::{LensFailure, Notice};
pub use panics::Panics;
pub use phone_check::{CheckInk, PhoneQuestion};
pub use plates::{PlateJob, PlatedJob};
pub use platform::Obstacle;
pub use playback::Playback;
pub use reticle::Reticle;
pub use search::{Placing, SearchJob, SearchedJob};
pub use show::Show;
pub use step::{Cause, Step};
pub use toy_refusal::{RefusalKind, ToyRefusal};
pub use watching::{WatchJob, WatchedJob};

use notice::Notices;

/// The app.
#[derive(Debug)]
pub struct App {
    step: Step,
    platform: Platform,
    commanded: Commanded,
    captures: Captures,
    recorder: Option<Recorder>,
    n_recordings: u64,
    /// Whether the person began before the camera was allowed.
    wants_to_begin: bool,
    /// Whether the tracker must start a new world.
    wants_new_world: bool,
    /// Whether the platform must hold the toy's place.
    wants_anchor: bool,
    /// Whether a person uses the printed card.
    uses_card: bool,
    /// The platform's description of its AR session.
    ar_words: Option<Translated>,
    language: Language,
    /// Disclosure on the first screen that the platform's terms require.
    disclosure: Option<Translated>,
    /// Time since the tracker began to relocalise with nothing placed.
    relocalising_s: f64,
    shows_profile: bool,
    /// The check of a new phone, while it runs.
    phone_check: Option<PhoneCheck>,
    arrivals: Arrivals,
    /// Sum of the seconds between accepted frames; a pause counts as the
    /// [longest gap](app_scene::camera_frame::LONGEST_GAP_S).
    time_s: f64,
    /// Time of the latest loss of the graphics device.
    device_lost_s: Option<f64>,
    /// The reason why the latest picture that failed did so.
    picture_failure: Option<String>,
    n_failed_pictures: u32,
    fade: Fade,
    latest: Option<Arc<CameraFrame>>,
    /// The latest reliable camera.
    camera: Option<Camera>,
    toy: Arc<Toy>,
    /// The files of toys, while a person selects one.
    toy_files: Option<Vec<String>>,
    table: Option<FoundPlane>,
    plating: Plating,
    plates: Vec<Plate>,
    /// Exposure of the plates, if the platform reports it; frames are relative to it.
    plate_exposure: Option<f64>,
    ghost: Option<Ghost>,
    ghost_shape: GhostShape,
    search: Search,
    /// Whether the toy is searched for, and no haptic pulse has told that it was found.
    owes_knock: bool,
    /// The place at which the platform has recognised the toy.
    scanned_at: Option<DVec3>,
    /// Whether the reticle was on a table in the previous frame.
    had_reticle: bool,
    lens: Lens,
    place: Option<Place>,
    n_places: u64,
    playback: Playback,
    notices: Notices,
    log: Log,
    /// `None` if the shell stores nothing between launches.
    start: Option<Start>,
}

impl App {
    /// An app with its first toy.
    #[must_use]
    pub fn new(toy: Arc<Toy>) -> Self {
        Self {
            step: Step::default(),
            platform: Platform::default(),
            commanded: Commanded::default(),
            captures: Captures::default(),
            recorder: None,
            n_recordings: 0,
            wants_to_begin: false,
            wants_new_world: false,
            wants_anchor: false,
            uses_card: false,
            ar_words: None,
            language: Language::default(),
            disclosure: None,
            relocalising_s: 0.0,
            shows_profile: false,
            phone_check: None,
            arrivals: Arrivals::default(),
            time_s: 0.0,
            device_lost_s: None,
            picture_failure: None,
            n_failed_pictures: 0,
            fade: Fade::default(),
            latest: None,
            camera: None,
            playback: Playback::of(&toy),
            ghost_shape: GhostShape::of(&toy),
            toy,
            toy_files: None,
            table: None,
            plating: Plating::default(),
            plates: Vec::new(),
            plate_exposure: None,
            ghost: None,
            search: Search::default(),
            owes_knock: false,
            scanned_at: None,
            had_reticle: false,
            lens: Lens::default(),
            place: None,
            n_places: 0,
            notices: Notices::default(),
            log: Log::default(),
            start: None,
        }
    }

    /// Processes an event, and returns the resulting commands in their order.
    #[must_use]
    pub fn event(&mut self, event: ShellEvent) -> Vec<ShellCommand> {
        let (step, question) = (self.step, self.question());
        let mut commands = Vec::new();
        match event {
            ShellEvent::Permission(permission) => self.permission(permission),
            ShellEvent::Foreground(is_foreground) => self.foreground(is_foreground, &mut commands),
            ShellEvent::Surface(size_px) => self.platform.surface_px = size_px,
            ShellEvent::Graphics(state) => self.graphics(state, &mut commands),
            ShellEvent::ArSession(ar_session) => self.ar_session(ar_session, None),
            ShellEvent::ArTrouble(ar_session, words) => self.ar_session(ar_session, Some(words)),
            ShellEvent::CardRefused => self.refuse_card(),
            ShellEvent::Frame(frame) => self.frame(*frame, &mut commands),
            ShellEvent::Thermal(thermal) => self.platform.thermal = thermal,
            ShellEvent::MemoryLow => self.memory_low(),
            ShellEvent::Plated(done) => self.plated(done),
            ShellEvent::Searched(done) => self.searched(done, &mut commands),
            ShellEvent::Aligned(done) => self.aligned(*done, &mut commands),
            ShellEvent::Watched(done) => self.watched(*done),
            ShellEvent::ToyFiles(files) => self.toy_files = Some(files),
            ShellEvent::Toy(read) => self.take_toy(read),
            ShellEvent::PictureFailed(reason) => self.picture_failed(reason),
            ShellEvent::Saved(saved) => self.tell(Notice::Saved(saved)),
            ShellEvent::Filmed(filmed) => self.filmed(filmed),
            ShellEvent::Recorded(recorded) => self.recorded(recorded),
            ShellEvent::FreeSpace(free_bytes) => self.free_space(free_bytes),
            ShellEvent::Started(history) => self.started(history),
            ShellEvent::Language(language) => self.language = language,
            ShellEvent::Restarted => self.tell(Notice::Restarted),
            ShellEvent::User(action) => self.act(action, &mut commands),
        }
        let asked = Asked {
            lens: self.lens.is_awaited(),
            held_exposure: self.phone_check.is_some_and(|check| check.holds_exposure()),
            // Later steps already have the table.
            card: (self.uses_card && self.step <= Step::PlaceToy)
                || self.phone_check.is_some_and(|check| check.shows_card()),
        };
        let wanted = self
            .commanded
            .next(self.step, &self.platform, (self.captures, asked));
        self.captures = wanted.captures;
        let job = self.follow_recording(wanted.captures.recording);
        let is_new_world = std::mem::take(&mut self.wants_new_world);
        commands.extend(self.commanded.follow(wanted, is_new_world, job));
        let is_new_question = self.question().is_some() && self.question() != question;
        if self.step != step || is_new_question {
            commands.push(PlatformCommand::Announce(self.step).into());
        }
        commands
    }

    /// What a person is asked about the place of the toy; `None` while nothing has to be answered.
    fn question(&self) -> Option<Placing> {
        let placing = (self.step == Step::PlaceToy).then(|| self.placing());
        placing.filter(|placing| matches!(placing, Placing::Asked { is_searching: false } | Placing::ByHand))
    }

    /// The current step.
    #[must_use]
    pub fn step(&self) -> Step {
        self.step
    }

    /// The obstacle to the current step.
    #[must_use]
    pub fn obstacle(&self) -> Option<Obstacle> {
        self.platform.obstacle(self.step)
    }

    /// The platform's description of its AR session, in one or two sentences; `None` while it is
    /// able.
    #[must_use]
    pub fn ar_words(&self) -> Option<&str> {
        Some(self.ar_words.as_ref()?.in_language(self.language))
    }

    /// Whether a person uses the printed card, which is detected up to [`Step::PlaceToy`].
    #[must_use]
    pub fn uses_card(&self) -> bool {
        self.uses_card
    }

    /// The language of its texts.
    #[must_use]
    pub fn language(&self) -> Language {
        self.language
    }

    /// Sets the disclosure on the first screen that the platform's terms require.
    pub fn disclose(&mut self, words: Translated) {
        self.disclosure = Some(words);
    }

    /// The disclosure.
    #[must_use]
    pub fn disclosure(&self) -> Option<&str> {
        Some(self.disclosure.as_ref()?.in_language(self.language))
    }

    /// The current notice, which is shown for some seconds.
    #[must_use]
    pub fn notice(&self) -> Option<&Notice> {
        self.notices.at(self.time_s)
    }

    /// The progress of the photograph of the empty place, in its step.
    #[must_use]
    pub fn plate_step(&self) -> Option<&PlateStep> {
        self.plating.step.as_ref()
    }

    /// The result of the latest alignment.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        self.place.as_ref()?.verdict.as_ref()
    }

    /// Whether the card is in the latest picture.
    #[must_use]
    pub fn sees_card(&self) -> bool {
        self.latest
            .as_ref()
            .is_some_and(|frame| frame.world_from_card.is_some())
    }

    /// Whether the app waits for a dark picture of the lens.
    #[must_use]
    pub fn is_taking_lens(&self) -> bool {
        self.lens.is_awaited()
    }

    /// Whether there is a photograph of the empty place.
    #[must_use]
    pub fn has_plate(&self) -> bool {
        !self.plates.is_empty()
    }

    /// The moment of the clip.
    #[must_use]
    pub fn playback(&self) -> &Playback {
        &self.playback
    }

    /// The toy.
    #[must_use]
    pub fn toy(&self) -> &Arc<Toy> {
        &self.toy
    }

    /// Whether a video is being made.
    #[must_use]
    pub fn is_making_video(&self) -> bool {
        self.commanded.captures.video
    }

    /// Whether the session is being recorded.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.commanded.captures.recording
    }

    /// Whether times are displayed over the picture.
    #[must_use]
    pub fn shows_profile(&self) -> bool {
        self.shows_profile
    }

    /// The requested number of pictures per second.
    #[must_use]
    pub fn frames_per_s(&self) -> u32 {
        self.commanded.frames_per_s
    }

    /// The device's thermal state.
    #[must_use]
    pub fn thermal(&self) -> Thermal {
        self.platform.thermal
    }

    /// The log of events, for an export.
    #[must_use]
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Moves to the step that follows from a cause, and prepares for it.
    fn go(&mut self, cause: Cause) {
        let next = self.step.after(cause);
        self.note(&(cause, next));
        if next == self.step && cause != Cause::StartOver && cause != Cause::WorldLost {
            return;
        }
        self.step = next;
        self.lens.give_up();
        if next != Step::PlaceToy {
            // A search holds pictures of the size of the camera's.
            self.search.give_up();
        }
        self.toy_files = None;
        // Notices of the previous step are no longer useful.
        self.notices = Notices::default();
        match next {
            Step::Welcome | Step::FindTable => {
                self.forget_place();
                if next == Step::Welcome {
                    self.check_phone(false);
                }
            }
            Step::TakePlate => {
                self.place = None;
                self.plating.begin();
            }
            Step::PlaceToy => self.enter_ghost(cause),
            Step::Align => self.place_toy(),
            Step::Play => {}
        }
        if next != Step::Play {
            self.fade = Fade::default();
        }
    }

    /// Starts the question about the toy's place: the app searches for a toy that was just put
    /// down, and the person places one that was detected before.
    fn enter_ghost(&mut self, cause: Cause) {
        let place = self.place.take();
        self.owes_knock = true;
        match cause {
            Cause::PlateTaken | Cause::PlateSkipped => self.search.begin(!self.plates.is_empty()),
            _ => self.search.give_up(),
        }
        let seen = place.filter(Place::is_known).zip(self.table.as_ref());
        let seen =
            seen.and_then(|(place, table)| Ghost::standing(&self.toy, table, place.world_from_object()));
        self.ghost = seen.or(self.ghost.take());
    }

    /// Drops all state of the current place.
    fn forget_place(&mut self) {
        self.table = None;
        self.plates.clear();
        self.plate_exposure = None;
        self.ghost = None;
        self.scanned_at = None;
        self.lens = Lens::default();
        if let Some(check) = &mut self.phone_check {
            check.forget_place();
        }
        self.place = None;
        self.camera = None;
        self.plating.step = None;
    }
}
