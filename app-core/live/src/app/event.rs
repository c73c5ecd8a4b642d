//! What reaches the app, and what it asks of its shell.

use std::sync::Arc;

use glam::DVec2;

use super::aligning::{AlignJob, AlignedJob};
use super::language::Language;
use super::launch_history::LaunchHistory;
use super::plates::{PlateJob, PlatedJob};
use super::search::{SearchJob, SearchedJob};
use super::step::Step;
use app_scene::camera_frame::CameraFrame;
use app_scene::toy::{ClipId, Toy};
use app_session::recording::{RecordingJob, RecordingOutcome};

pub use app_pipeline::governor::Thermal;

/// Whether the camera may be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Permission {
    /// Nobody was asked yet.
    #[default]
    Unknown,
    /// It may.
    Granted,
    /// It may not; asking again is possible.
    Denied,
    /// It may not, and only the system's settings change that.
    Barred,
}

/// How the platform's AR session is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ArSession {
    /// It runs, or would if it were asked to.
    #[default]
    Able,
    /// What it needs is looked for or being installed: it is asked for all the same.
    Installing,
    /// Something else has the camera, such as a call.
    Interrupted,
    /// The device has none, or one that is too old.
    Unsupported,
    /// It ended by itself and may be started again.
    Failed,
}

/// How the graphics device is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum GraphicsState {
    /// Pipelines are being compiled.
    #[default]
    Starting,
    /// It draws.
    Ready,
    /// It was lost and is opened anew.
    Lost,
}

/// What became of something that was to be saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Saved {
    /// It is where people look for it.
    Done,
    /// There is no room left.
    NoRoom,
    /// It may not be put there.
    NotAllowed,
    /// It failed otherwise.
    Failed,
}

/// A recording that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// Where a person finds it.
    pub file: String,
    /// What became of it.
    pub outcome: RecordingOutcome,
}

/// What a person does, by a touch or a button.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UserAction {
    /// The first button.
    Begin,
    /// The system's settings, where the camera can be allowed.
    OpenSettings,
    /// A point of the camera's picture was tapped, in its pixels.
    Tap(DVec2),
    /// The place that the reticle lies on.
    TapReticle,
    /// A finger went from one pixel of the camera's picture to another.
    Drag {
        /// Where it was.
        from_px: DVec2,
        /// Where it is.
        to_px: DVec2,
    },
    /// Two fingers turned by so much, counterclockwise in the picture; radians.
    Twist(f64),
    /// The place stays without a picture of its own.
    SkipPlate,
    /// The lens lies in its place on the card: it is to be photographed.
    TakeLens,
    /// The ghost stands where the toy does.
    Placed,
    /// It does not: a person moves and turns it.
    ByHand,
    /// The toy is to be searched for where the ghost is.
    LookAgain,
    /// Back to the ghost.
    Replace,
    /// The toy was lifted away: the place is to be photographed.
    RetakePlate,
    /// All from the table on.
    StartOver,
    /// To the first screen, and out of whatever is in the way.
    Leave,
    /// What this device was found not to have may be there by now.
    TryAgain,
    /// The printed card is to be looked for, which costs the camera time, or no longer.
    UseCard(bool),
    /// Another clip, or the pose as authored.
    Choose(Option<ClipId>),
    /// On or off.
    Play(bool),
    /// To a time of the clip, in seconds.
    Scrub(f64),
    /// The next picture.
    SavePhoto,
    /// On or off.
    Video(bool),
    /// On or off.
    Record(bool),
    /// Times of passes over the picture, on or off.
    ShowProfile(bool),
    /// The questions of a new phone, from the first on, or no more of them.
    CheckPhone(bool),
    /// To the question of [`App::phone_question`](super::App::phone_question).
    Answer(bool),
    /// A toy of the person's own.
    PickToy,
    /// That of [`ShellEvent::ToyFiles`], by its place there; none to keep the one of now.
    ChooseToy(Option<usize>),
    /// The log, and the latest recording and profile.
    Share,
    /// The preset that the shell has chosen, in place of the simplest.
    RestorePreset,
}

/// What a shell tells.
#[derive(Debug)]
pub enum ShellEvent {
    /// The camera's permission, at the start and whenever it changes.
    Permission(Permission),
    /// The app came to the front, or left it.
    Foreground(bool),
    /// There is something to draw on, of so many pixels, or no longer.
    Surface(Option<[u32; 2]>),
    /// The graphics device.
    Graphics(GraphicsState),
    /// The AR session.
    ArSession(ArSession),
    /// The same, with what the platform says of it in a sentence or two.
    ArTrouble(ArSession, String),
    /// The platform does not look for the printed card, though it was asked to.
    CardRefused,
    /// A camera frame.
    Frame(Box<CameraFrame>),
    /// How hot the device is.
    Thermal(Thermal),
    /// Memory is short.
    MemoryLow,
    /// [`WorkCommand::Plate`] ended; none where its thread did not come to an end.
    Plated(Option<Box<PlatedJob>>),
    /// [`WorkCommand::Search`] ended; none where its thread did not come to an end.
    Searched(Option<Box<SearchedJob>>),
    /// [`WorkCommand::Align`] ended; none where its thread did not come to an end.
    Aligned(Option<Box<AlignedJob>>),
    /// Names of toys' files that a person can choose from, in answer to [`WorkCommand::PickToy`].
    ToyFiles(Vec<String>),
    /// A toy was read, or why it was not.
    Toy(Result<Arc<Toy>, String>),
    /// A photo, a video or what is to be shared was saved, or not.
    Saved(Saved),
    /// [`WorkCommand::Record`]: it has ended, by itself or since it was asked to.
    Recorded(Recorded),
    /// What is free where recordings go, in bytes; once a second.
    FreeSpace(u64),
    /// What was kept from start to start, once this one has [begun](LaunchHistory::begin): before anything else.
    Started(LaunchHistory),
    /// This app has taken the place of one that a panic ended; see [`Panics`](super::Panics).
    Restarted,
    /// The language that the person reads, before anything is shown in it.
    Language(Language),
    /// What a person does with the interface, which [`Live`](crate::live::Live) has.
    User(UserAction),
}

/// What a shell is to do.
#[derive(Debug)]
pub enum ShellCommand {
    /// What takes the platform.
    Platform(PlatformCommand),
    /// What takes no more than files and threads.
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

/// What a platform is asked for, by its shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlatformCommand {
    /// Ask for the camera, and tell.
    AskPermission,
    /// Show the system's settings of this app.
    OpenSettings,
    /// Run the AR session, from its start where it ran before and the world is to be another.
    RunTracking {
        /// Whether level planes are looked for, which costs.
        finds_planes: bool,
        /// Whether the printed card is, which costs more.
        finds_card: bool,
        /// Whether the world begins anew.
        is_new_world: bool,
    },
    /// Pause it.
    PauseTracking,
    /// Hold exposure, white balance and focus, or let go of them.
    LockExposure(bool),
    /// Expose at a sixty-fourth of what is held, or as near to that as the camera can, and hold that; or hold again what was held
    /// before. Where the camera cannot, nothing is to be done.
    Underexpose(bool),
    /// Hold a place of the world as an anchor of that number, in place of the one before.
    HoldAnchor {
        /// Its number.
        id: u64,
        /// Rigid.
        world_from_anchor: glam::DMat4,
    },
    /// Keep the screen on, or let it go off.
    KeepAwake(bool),
    /// Frames a second to ask the camera for.
    FrameRate(u32),
    /// Open the graphics device anew.
    ReopenDevice,
    /// A step has begun: say it to those who do not see the screen, in the words of [`announced`](crate::interface::announced).
    Announce(Step),
    /// Something was found: one short knock that a hand feels.
    Knock,
}

/// Work that is the same on each platform.
#[derive(Debug)]
pub enum WorkCommand {
    /// Run this on another thread, and tell.
    Plate(Box<PlateJob>),
    /// The same.
    Search(Box<SearchJob>),
    /// The same.
    Align(Box<AlignJob>),
    /// Save the next finished picture.
    SavePhoto,
    /// Begin a video of the finished pictures, or end and save it.
    Video(bool),
    /// Write this recording on another thread, and tell; none where the one before was ended: what waits of it is still
    /// written.
    Record(Option<Box<RecordingJob>>),
    /// Let a person choose a toy's file and tell the toy, or tell the files that there are.
    PickToy,
    /// Read the toy's file of that name, on another thread, and tell.
    ReadToy(String),
    /// Hand log, recording and profile to whoever the person chooses.
    Share,
    /// Keep this text for the next start, at once: see [`LaunchHistory`].
    Remember(String),
}
