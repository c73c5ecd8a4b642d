//! Events for the app, and commands to its shell.

use std::sync::Arc;

use glam::DVec2;

use super::aligning::{AlignJob, AlignedJob};
use super::language::{Language, Translated};
use super::launch_history::LaunchHistory;
use super::plates::{PlateJob, PlatedJob};
use super::search::{SearchJob, SearchedJob};
use super::step::Step;
use super::toy_refusal::ToyRefusal;
use super::watching::{WatchJob, WatchedJob};
use app_scene::camera_frame::CameraFrame;
use app_scene::toy::{ClipId, Toy};
use app_session::recording::{RecordingJob, RecordingOutcome};

pub use app_pipeline::governor::Thermal;

/// Permission to use the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Permission {
    /// The person was not asked yet.
    #[default]
    Unknown,
    /// The camera may be used.
    Granted,
    /// The camera may not be used; asking again is possible.
    Denied,
    /// The camera may not be used, and only the system's settings can change that.
    Barred,
}

/// State of the platform's AR session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ArSession {
    /// It runs, or can run.
    #[default]
    Able,
    /// A required part is being checked or installed: the session can be requested nevertheless.
    Installing,
    /// Something else uses the camera, such as a call.
    Interrupted,
    /// The device has no AR session, or a version that is too old.
    Unsupported,
    /// It ended unexpectedly and can be started again.
    Failed,
}

/// State of the graphics device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum GraphicsState {
    /// Pipelines are being compiled.
    #[default]
    Starting,
    /// It draws.
    Ready,
    /// It was lost and is being opened again.
    Lost,
}

/// Outcome of saving.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Saved {
    /// It is saved at the usual place.
    Done,
    /// There is not enough space.
    NoRoom,
    /// The place is not writable.
    NotAllowed,
    /// It is in the app's own folder, but no other app gets it.
    NotShared,
    /// It failed for another reason.
    Failed,
}

/// The reason why a video has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VideoEnding {
    /// [`WorkCommand::Video`] ended it.
    Asked,
    /// The file is as large as its format allows.
    TooLarge,
    /// It could not begin or go on.
    Broken,
}

/// A video that has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Filmed {
    /// The outcome of saving it.
    pub saved: Saved,
    /// The reason why it ended.
    pub ending: VideoEnding,
}

/// A recording that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// The file's place, for the person.
    pub file: String,
    /// The recording's outcome.
    pub outcome: RecordingOutcome,
}

/// An action of the person, by a touch or a button.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UserAction {
    /// The button of the first screen.
    Begin,
    /// Open the system's settings, which can allow the camera.
    OpenSettings,
    /// A point of the camera's picture was tapped, in its pixels.
    Tap(DVec2),
    /// The place under the reticle was tapped.
    TapReticle,
    /// A finger moved from one pixel of the camera's picture to another.
    Drag {
        /// The finger's previous pixel.
        from_px: DVec2,
        /// The finger's new pixel.
        to_px: DVec2,
    },
    /// Two fingers turned by this angle in radians, counterclockwise in the picture.
    Twist(f64),
    /// Go on without a photograph of the empty place.
    SkipPlate,
    /// The lens is at its place on the card: photograph it.
    TakeLens,
    /// The ghost is at the toy's place.
    Placed,
    /// The ghost is not at the toy's place: the person moves and turns it.
    ByHand,
    /// Search for the toy at the ghost's place.
    LookAgain,
    /// Return to the ghost.
    Replace,
    /// The toy was removed: photograph the place.
    RetakePlate,
    /// Start again from the table.
    StartOver,
    /// Return to the first screen, and close messages.
    Leave,
    /// Check again for a part that this device lacked.
    TryAgain,
    /// Turn detection of the printed card, which costs the camera time, on or off.
    UseCard(bool),
    /// Select another clip, or the pose as authored.
    Choose(Option<ClipId>),
    /// Start or pause the clip.
    Play(bool),
    /// Go to a time of the clip, in seconds.
    Scrub(f64),
    /// Save the next picture.
    SavePhoto,
    /// Turn the video on or off.
    Video(bool),
    /// Turn the recording on or off.
    Record(bool),
    /// Show or hide times of passes over the picture.
    ShowProfile(bool),
    /// Start the questions of a new phone from the first one, or end them.
    CheckPhone(bool),
    /// Answer the question of [`App::phone_question`](super::App::phone_question).
    Answer(bool),
    /// Select a toy of the person's own.
    PickToy,
    /// Select a toy of [`ShellEvent::ToyFiles`] by its index; `None` keeps the current one.
    ChooseToy(Option<usize>),
    /// Share the log, and the latest recording and profile.
    Share,
    /// Use the preset that the shell has chosen, in place of the simplest.
    RestorePreset,
}

/// An event from a shell.
#[derive(Debug)]
pub enum ShellEvent {
    /// The camera's permission, at the start and whenever it changes.
    Permission(Permission),
    /// The app came to the foreground, or left it.
    Foreground(bool),
    /// The size in pixels of the surface to draw on; `None` if there is none any longer.
    Surface(Option<[u32; 2]>),
    /// The state of the graphics device.
    Graphics(GraphicsState),
    /// The state of the AR session.
    ArSession(ArSession),
    /// The state of the AR session, with the platform's description of one or two sentences.
    ArTrouble(ArSession, Translated),
    /// The platform does not detect the printed card, though it was asked to.
    CardRefused,
    /// A camera frame.
    Frame(Box<CameraFrame>),
    /// The device's thermal state.
    Thermal(Thermal),
    /// Memory is short.
    MemoryLow,
    /// [`WorkCommand::Plate`] ended; `None` if its thread did not end normally.
    Plated(Option<Box<PlatedJob>>),
    /// [`WorkCommand::Search`] ended; `None` if its thread did not end normally.
    Searched(Option<Box<SearchedJob>>),
    /// [`WorkCommand::Align`] ended, [without a result](AlignJob::without_result) if its thread did
    /// not end normally.
    Aligned(Box<AlignedJob>),
    /// [`WorkCommand::Watch`] ended, [without a result](WatchJob::without_result) if its thread did
    /// not end normally.
    Watched(Box<WatchedJob>),
    /// Names of available toy files, in answer to [`WorkCommand::PickToy`].
    ToyFiles(Vec<String>),
    /// A toy was read, or could not be read for this reason.
    Toy(Result<Arc<Toy>, ToyRefusal>),
    /// The toy's picture could not be made for this reason, on a device that works.
    /// [`Live`](crate::live::Live) reports it.
    PictureFailed(String),
    /// The outcome of saving a photo or files to share.
    Saved(Saved),
    /// The video of [`WorkCommand::Video`] has ended, or could not begin.
    Filmed(Filmed),
    /// The recording of [`WorkCommand::Record`] has ended.
    Recorded(Recorded),
    /// Free space at the recordings' place, in bytes; once a second.
    FreeSpace(u64),
    /// The history of launches, after this one has [begun](LaunchHistory::begin); the first event
    /// of all.
    Started(LaunchHistory),
    /// This app replaces one that a panic ended; see [`Panics`](super::Panics).
    Restarted,
    /// The person's language, before any text is shown.
    Language(Language),
    /// An action in the interface, which [`Live`](crate::live::Live) contains.
    User(UserAction),
}

/// A command to a shell.
#[derive(Debug)]
pub enum ShellCommand {
    /// A command that needs the platform.
    Platform(PlatformCommand),
    /// A command that needs only files and threads.
    Work(WorkCommand),
}

impl From<PlatformCommand> for ShellCommand {
    fn from(command: PlatformCommand) -> Self {
        Self::Platform(command)
    }
}

impl From<WorkCommand> for ShellCommand {
    fn from(command: WorkCommand) -> Self {
        Self::Work(command)
    }
}

/// A command to the platform, executed by its shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlatformCommand {
    /// Ask for permission to use the camera, and report the answer.
    AskPermission,
    /// Show the system's settings of this app.
    OpenSettings,
    /// Run the AR session, restarted if it ran before and a new world is required.
    RunTracking {
        /// Whether horizontal planes are detected, which costs time.
        finds_planes: bool,
        /// Whether the printed card is detected, which costs more.
        finds_card: bool,
        /// Whether the people in the pictures are masked, if the platform can, which warms the
        /// phone.
        finds_people: bool,
        /// Whether depths are measured, if the phone can, which costs time and warms it.
        measures_depth: bool,
        /// Whether the session starts a new world.
        is_new_world: bool,
    },
    /// Pause the AR session.
    PauseTracking,
    /// Lock exposure, white balance and focus, or release them.
    LockExposure(bool),
    /// Set the exposure to a sixty-fourth of the locked one, or as near as the camera can, and lock
    /// it; or restore the exposure from before. If the camera cannot, do nothing.
    Underexpose(bool),
    /// Hold a place of the world as an anchor of this number, in place of the previous one.
    HoldAnchor {
        /// Number of the anchor.
        id: u64,
        /// Rigid transform of the anchor.
        world_from_anchor: glam::DMat4,
    },
    /// Keep the screen on, or let it turn off.
    KeepAwake(bool),
    /// Set the camera's frames per second.
    FrameRate(u32),
    /// Open the graphics device again.
    ReopenDevice,
    /// Announce to screen readers the step that has begun, or the question about the toy's place,
    /// in the words of [`announced`](crate::interface::announced).
    Announce(Step),
    /// Give one short haptic pulse: something was found.
    Knock,
}

/// Work that does not depend on the platform.
#[derive(Debug)]
pub enum WorkCommand {
    /// Run this on another thread, and report its result.
    Plate(Box<PlateJob>),
    /// Run this on another thread, and report its result.
    Search(Box<SearchJob>),
    /// Run this on another thread, and report its result.
    Align(Box<AlignJob>),
    /// Run this on another thread, and report its result.
    Watch(Box<WatchJob>),
    /// Save the next finished picture.
    SavePhoto,
    /// Start a video of the finished pictures, or end and save it.
    Video(bool),
    /// Write this recording on another thread, and report its outcome; `None` if the previous one
    /// was ended: its remaining data is still written.
    Record(Option<Box<RecordingJob>>),
    /// Let the person choose a toy's file and report the toy, or report the available files.
    PickToy,
    /// Read the toy's file of this name on another thread, and report the toy.
    ReadToy(String),
    /// Share log, recording and profile.
    Share,
    /// Store this text for the next launch, at once: see [`LaunchHistory`].
    Remember(String),
}
