//! State that the platform reports, and the requests to it.

use super::event::{
    ArSession, GraphicsState, Permission, PlatformCommand, ShellCommand, Thermal, WorkCommand,
};
use super::step::Step;
use app_scene::camera_frame::Tracking;
use app_session::recording::RecordingJob;

/// State that the platform reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Platform {
    pub(super) permission: Permission,
    pub(super) is_foreground: bool,
    pub(super) surface_px: Option<[u32; 2]>,
    pub(super) graphics: GraphicsState,
    pub(super) ar_session: ArSession,
    pub(super) thermal: Thermal,
    /// Tracking state of the latest frame.
    pub(super) tracking: Tracking,
    /// Free space for recordings, if it was reported.
    pub(super) free_bytes: Option<u64>,
}

/// The reason why the app cannot continue for now. Each has its text, and its remedy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Obstacle {
    /// The device reports no AR; the check can be repeated.
    NoAr,
    /// The AR service is being checked for or installed: the app continues by itself.
    Installing,
    /// The camera is not permitted; the permission can be requested again.
    CameraDenied,
    /// The camera is not permitted; only the system's settings help.
    CameraBarred,
    /// The device is too hot: the app continues by itself when it has cooled.
    TooHot,
    /// Another app uses the camera: the app continues by itself.
    Interrupted,
    /// The AR session ended: the person starts over.
    ArFailed,
    /// Graphics are being set up, for the first time or again: the app continues by itself.
    Preparing,
    /// The camera's pose is unknown: the person gets advice.
    Tracking(Tracking),
}

impl Platform {
    /// The first obstacle to a step.
    pub(super) fn obstacle(&self, step: Step) -> Option<Obstacle> {
        if self.ar_session == ArSession::Unsupported {
            return Some(Obstacle::NoAr);
        }
        match self.permission {
            Permission::Denied => return Some(Obstacle::CameraDenied),
            Permission::Barred => return Some(Obstacle::CameraBarred),
            Permission::Unknown | Permission::Granted => {}
        }
        if step == Step::Welcome {
            return None;
        }
        let obstacles = [
            (self.thermal == Thermal::Critical, Obstacle::TooHot),
            (self.ar_session == ArSession::Installing, Obstacle::Installing),
            (self.ar_session == ArSession::Interrupted, Obstacle::Interrupted),
            (self.ar_session == ArSession::Failed, Obstacle::ArFailed),
            (self.graphics != GraphicsState::Ready, Obstacle::Preparing),
            (
                self.tracking != Tracking::Normal,
                Obstacle::Tracking(self.tracking),
            ),
        ];
        let mut met = obstacles.into_iter().filter(|(is_met, _)| *is_met);
        met.next().map(|(_, obstacle)| obstacle)
    }

    /// Whether the camera may run.
    fn can_track(&self) -> bool {
        self.is_foreground
            && self.permission == Permission::Granted
            && matches!(self.ar_session, ArSession::Able | ArSession::Installing)
            && self.thermal < Thermal::Critical
    }
}

/// Captures that a person wants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Captures {
    pub(super) video: bool,
    pub(super) recording: bool,
}

/// Temporary requests for the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Asked {
    /// A dark picture of the lens.
    pub(super) lens: bool,
    pub(super) held_exposure: bool,
    pub(super) card: bool,
}

/// Requested state of the shell, which holds until the next request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Commanded {
    tracking: bool,
    finds_planes: bool,
    finds_card: bool,
    finds_people: bool,
    measures_depth: bool,
    locks_exposure: bool,
    underexposes: bool,
    /// The step in which the phone is or was warm: what warms it most stays off until the next one,
    /// since each change runs the session anew.
    warm_in: Option<Step>,
    is_awake: bool,
    pub(super) frames_per_s: u32,
    pub(super) captures: Captures,
}

impl Commanded {
    /// The state that a step requires, after this one.
    pub(super) fn next(&self, step: Step, platform: &Platform, (captures, asked): (Captures, Asked)) -> Self {
        let tracking = step != Step::Welcome && platform.can_track();
        let warm_in = if platform.thermal == Thermal::Nominal {
            self.warm_in.filter(|warm_in| *warm_in == step)
        } else {
            Some(step)
        };
        let is_cool = tracking && warm_in.is_none();
        Self {
            tracking,
            finds_planes: tracking && step == Step::FindTable,
            finds_card: tracking && asked.card,
            // Of all that warms a phone, masks and depths are what a picture can most easily do
            // without.
            finds_people: is_cool && step == Step::Play,
            // From the step before the toy is placed, where the session runs anew in any case.
            measures_depth: is_cool && step >= Step::TakePlate,
            // Plate and frames are compared with one another.
            locks_exposure: tracking && (step >= Step::PlaceToy || asked.held_exposure),
            underexposes: tracking && step == Step::PlaceToy && asked.lens,
            warm_in,
            is_awake: platform.is_foreground && step != Step::Welcome,
            frames_per_s: if platform.thermal >= Thermal::Serious {
                30
            } else {
                60
            },
            captures: Captures {
                video: captures.video && tracking && step == Step::Play,
                // A recording is of one place, with one toy that stands there.
                recording: captures.recording && tracking && step == Step::Play,
            },
        }
    }

    /// Whether the camera must run.
    pub(super) fn is_tracking(&self) -> bool {
        self.tracking
    }

    /// The commands that lead from the present state to `wanted`; `job` is the recording that
    /// begins.
    pub(super) fn follow(
        &mut self,
        wanted: Self,
        is_new_world: bool,
        job: Option<Box<RecordingJob>>,
    ) -> Vec<ShellCommand> {
        let mut commands = Vec::new();
        // Captures are saved before the camera stops.
        if wanted.captures.video != self.captures.video {
            commands.push(WorkCommand::Video(wanted.captures.video).into());
        }
        if wanted.captures.recording != self.captures.recording {
            commands.push(WorkCommand::Record(job).into());
        }
        if wanted.frames_per_s != self.frames_per_s {
            commands.push(PlatformCommand::FrameRate(wanted.frames_per_s).into());
        }
        let run = |of: &Self| {
            [
                of.tracking,
                of.finds_planes,
                of.finds_card,
                of.finds_people,
                of.measures_depth,
            ]
        };
        let is_run = wanted.tracking && (is_new_world || run(&wanted) != run(self));
        // A dark exposure is a fraction of the locked one, which is locked anew after a run.
        let was_dark = self.underexposes && self.tracking;
        let is_dark = was_dark && wanted.underexposes && !is_run;
        if was_dark && !is_dark && wanted.tracking {
            commands.push(PlatformCommand::Underexpose(false).into());
        }
        if is_run {
            commands.push(
                PlatformCommand::RunTracking {
                    finds_planes: wanted.finds_planes,
                    finds_card: wanted.finds_card,
                    finds_people: wanted.finds_people,
                    measures_depth: wanted.measures_depth,
                    is_new_world,
                }
                .into(),
            );
        } else if !wanted.tracking && self.tracking {
            commands.push(PlatformCommand::PauseTracking.into());
        }
        let was_locked = self.locks_exposure && self.tracking;
        // A run may release the lock.
        let is_locked_anew = wanted.locks_exposure && is_run;
        if wanted.tracking && (is_locked_anew || wanted.locks_exposure != was_locked) {
            commands.push(PlatformCommand::LockExposure(wanted.locks_exposure).into());
        }
        if wanted.underexposes && !is_dark {
            commands.push(PlatformCommand::Underexpose(true).into());
        }
        if wanted.is_awake != self.is_awake {
            commands.push(PlatformCommand::KeepAwake(wanted.is_awake).into());
        }
        *self = wanted;
        commands
    }
}
