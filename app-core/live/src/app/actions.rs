//! Reactions to the person's actions and to changes of the platform.

use glam::DVec2;

use super::App;
use super::event::{
    ArSession, Filmed, GraphicsState, Permission, PlatformCommand, Saved, ShellCommand, UserAction,
    VideoEnding, WorkCommand,
};
use super::ghost::{Ghost, point_at};
use super::language::Translated;
use super::notice::Notice;
use super::platform::Obstacle;
use super::search::Placing;
use super::step::{Cause, Step};
use super::table::table_at;
use app_scene::scene::Camera;

/// Time in seconds within which a second loss of the graphics device is put down to the toy's
/// picture: drawing it again would lose the device again.
const LOST_AGAIN_S: f64 = 10.0;
/// Number of consecutive pictures that fail before the toy is given up: a platform may report one
/// frame with values that make no sense.
const MOST_FAILED_PICTURES: u32 = 3;

impl App {
    pub(super) fn act(&mut self, action: UserAction, commands: &mut Vec<ShellCommand>) {
        let is_on_picture = matches!(
            action,
            UserAction::Tap(_) | UserAction::TapReticle | UserAction::Drag { .. } | UserAction::Twist(_)
        );
        // While there is an obstacle, the app does not know what a pixel of the picture shows.
        if is_on_picture && (self.phone_check.is_some() || self.obstacle().is_some()) {
            return;
        }
        match action {
            UserAction::CheckPhone(is_on) => self.check_phone(is_on && self.step != Step::Welcome),
            UserAction::Answer(is_yes) => self.answer(is_yes),
            UserAction::Begin => self.begin(commands),
            UserAction::OpenSettings => commands.push(PlatformCommand::OpenSettings.into()),
            UserAction::Tap(pixel) => self.tap(pixel),
            UserAction::TapReticle => {
                if let (Step::FindTable, Some(pixel)) = (self.step, self.reticle_px()) {
                    self.tap(pixel);
                }
            }
            UserAction::Drag { from_px, to_px } => {
                self.by_hand(|ghost, camera| ghost.drag(camera, [from_px, to_px]));
            }
            UserAction::Twist(angle_rad) => self.by_hand(|ghost, _| ghost.turn(angle_rad)),
            UserAction::ByHand => self.by_hand(|_, _| {}),
            UserAction::LookAgain => {
                if let (Step::PlaceToy, Some(ghost)) = (self.step, &self.ghost) {
                    self.look_again(ghost.world_from_object().w_axis.truncate());
                }
            }
            UserAction::TakeLens => self.take_lens(),
            UserAction::SkipPlate => self.go(Cause::PlateSkipped),
            UserAction::Placed => self.placed(),
            UserAction::Replace => self.go(Cause::Replace),
            UserAction::RetakePlate => self.go(Cause::RetakePlate),
            UserAction::StartOver => self.start_over(),
            UserAction::Leave => self.go(Cause::Left),
            UserAction::TryAgain => self.try_again(),
            UserAction::UseCard(is_used) => self.uses_card = is_used,
            UserAction::Choose(clip) => self.playback.choose(&self.toy, clip),
            UserAction::Play(is_playing) => self.playback.play(is_playing),
            UserAction::Scrub(time_s) => self.playback.scrub(time_s),
            UserAction::SavePhoto => {
                if self.step == Step::Play {
                    commands.push(WorkCommand::SavePhoto.into());
                }
            }
            UserAction::Video(is_on) => self.captures.video = is_on,
            UserAction::Record(is_on) => self.want_recording(is_on),
            UserAction::ShowProfile(is_on) => self.shows_profile = is_on,
            UserAction::PickToy => commands.push(WorkCommand::PickToy.into()),
            UserAction::ChooseToy(chosen) => self.choose_toy(chosen, commands),
            UserAction::Share => commands.push(WorkCommand::Share.into()),
            UserAction::RestorePreset => self.restore_preset(commands),
        }
    }

    /// Starts in another world, whatever the state of the previous one.
    pub(super) fn start_over(&mut self) {
        if self.platform.ar_session == ArSession::Failed {
            self.ar_session(ArSession::Able, None);
        }
        self.go(Cause::StartOver);
        self.wants_new_world = self.step == Step::FindTable;
    }

    /// Asks again for things that this device was found to lack.
    fn try_again(&mut self) {
        if self.platform.ar_session == ArSession::Unsupported {
            self.ar_session(ArSession::Able, None);
            self.wants_new_world = self.step != Step::Welcome;
        }
    }

    /// The action of the platform's back gesture; `None` if it leaves the app.
    #[must_use]
    pub fn back(&self) -> Option<UserAction> {
        if self.step == Step::Welcome {
            return None;
        }
        let through = match self.obstacle() {
            Some(Obstacle::ArFailed) => Some(UserAction::StartOver),
            // The step stays visible below a message about tracking.
            Some(Obstacle::Tracking(_)) | None => None,
            Some(_) => Some(UserAction::Leave),
        };
        let open = match (&self.phone_check, &self.toy_files) {
            (Some(_), _) => Some(UserAction::CheckPhone(false)),
            (None, Some(_)) => Some(UserAction::ChooseToy(None)),
            (None, None) => None,
        };
        through.or(open).or(match self.step {
            Step::Welcome | Step::FindTable => None,
            Step::TakePlate | Step::PlaceToy => Some(UserAction::StartOver),
            Step::Align | Step::Play => Some(UserAction::Replace),
        })
    }

    fn begin(&mut self, commands: &mut Vec<ShellCommand>) {
        match self.platform.permission {
            Permission::Granted => self.go(Cause::Begun),
            Permission::Unknown | Permission::Denied if self.step == Step::Welcome => {
                self.wants_to_begin = true;
                commands.push(PlatformCommand::AskPermission.into());
            }
            _ => {}
        }
    }

    pub(super) fn permission(&mut self, permission: Permission) {
        self.platform.permission = permission;
        match permission {
            Permission::Granted => {
                if std::mem::take(&mut self.wants_to_begin) {
                    self.go(Cause::Begun);
                }
            }
            Permission::Denied | Permission::Barred => {
                self.wants_to_begin = false;
                self.go(Cause::CameraDenied);
            }
            Permission::Unknown => {}
        }
    }

    /// Changes the ghost for the person; nothing else moves it afterwards.
    fn by_hand(&mut self, change: impl FnOnce(&mut Ghost, &Camera)) {
        if self.step != Step::PlaceToy {
            return;
        }
        let camera = self.seen_by();
        if let (Some(ghost), Some(camera)) = (&mut self.ghost, camera) {
            change(ghost, &camera);
        }
        if !matches!(self.placing(), Placing::Waiting { .. } | Placing::Looking) {
            self.search.give_up();
        }
    }

    /// The camera of the picture that the person touches; `None` if its pose is unknown.
    fn seen_by(&self) -> Option<Camera> {
        self.latest.as_ref()?.camera()
    }

    fn tap(&mut self, pixel: DVec2) {
        match (self.step, self.seen_by(), &self.latest) {
            (Step::FindTable, Some(camera), Some(latest)) => {
                let Some(plane) = table_at(latest, &camera, pixel) else {
                    return self.tell(Notice::NoTableThere);
                };
                self.ghost = Ghost::at(&self.toy, &plane, (&camera, pixel)).ok().flatten();
                self.table = Some(plane);
                self.go(Cause::TableChosen);
            }
            (Step::PlaceToy, ..) => self.tap_toy(pixel),
            _ => {}
        }
    }

    /// Moves the ghost to a tapped pixel, and searches there unless the person turns the ghost.
    fn tap_toy(&mut self, pixel: DVec2) {
        let has_ring = self.placing() == Placing::ByHand;
        let (Some(camera), Some(table)) = (&self.seen_by(), &self.table) else {
            return;
        };
        match &mut self.ghost {
            Some(ghost) if has_ring => {
                // A touch of the ring is a turn that did not begin.
                if !ghost.move_beyond_ring(camera, pixel) || self.search.is_by_hand() {
                    return;
                }
            }
            Some(ghost) => ghost.move_to(camera, pixel),
            ghost => *ghost = Ghost::at(&self.toy, table, (camera, pixel)).ok().flatten(),
        }
        if let Some(at) = point_at(&table.world_from_plane, camera, pixel) {
            self.look_again(at);
        }
    }

    fn placed(&mut self) {
        if self.ghost.is_some() && self.camera.is_some() && !self.lens.is_awaited() {
            self.go(Cause::ToyPlaced);
        }
    }

    pub(super) fn foreground(&mut self, is_foreground: bool, commands: &mut Vec<ShellCommand>) {
        self.platform.is_foreground = is_foreground;
        self.follow_start(is_foreground, commands);
        // The picture after a pause differs from the one before: no old pose is faded in over it.
        self.fade = app_scene::camera_frame::Fade::default();
    }

    pub(super) fn graphics(&mut self, state: GraphicsState, commands: &mut Vec<ShellCommand>) {
        let was = std::mem::replace(&mut self.platform.graphics, state);
        match (was, state) {
            (_, GraphicsState::Lost) => {
                commands.push(PlatformCommand::ReopenDevice.into());
                let before_s = self.device_lost_s.replace(self.time_s);
                if before_s.is_some_and(|before_s| self.time_s - before_s < LOST_AGAIN_S) {
                    self.give_up_picture();
                }
            }
            (GraphicsState::Lost, GraphicsState::Ready) if self.notice() != Some(&Notice::PictureFailed) => {
                self.tell(Notice::DeviceRestarted);
            }
            _ => {}
        }
    }

    /// Handles a picture that failed for a reason that another device does not change. The reason
    /// is logged once: without the toy, the camera's own picture may fail as often as it comes.
    pub(super) fn picture_failed(&mut self, reason: String) {
        if self.picture_failure.as_ref() != Some(&reason) {
            self.note(&("no picture", &reason));
            self.picture_failure = Some(reason);
        }
        self.n_failed_pictures = self.n_failed_pictures.saturating_add(1);
        if self.n_failed_pictures >= MOST_FAILED_PICTURES {
            self.give_up_picture();
        }
    }

    /// Shows the camera's picture and the ghost in place of a toy that cannot be drawn.
    fn give_up_picture(&mut self) {
        self.n_failed_pictures = 0;
        if self.step == Step::Play {
            self.go(Cause::Replace);
            self.tell(Notice::PictureFailed);
        }
    }

    pub(super) fn ar_session(&mut self, ar_session: ArSession, words: Option<Translated>) {
        if let Some(words) = &words {
            self.note(&(ar_session, words));
        }
        self.platform.ar_session = ar_session;
        self.ar_words = words;
        if ar_session != ArSession::Able {
            self.platform.tracking = app_scene::camera_frame::Tracking::Starting;
        }
    }

    /// Handles a platform that does not detect the card: the table is found without it.
    pub(super) fn refuse_card(&mut self) {
        self.uses_card = false;
        self.tell(Notice::CardRefused);
    }

    pub(super) fn memory_low(&mut self) {
        if self.captures.recording || self.captures.video {
            self.captures = super::Captures::default();
            self.tell(Notice::MemoryLow);
        }
    }

    /// Handles the end of a video, which also ends by itself.
    pub(super) fn filmed(&mut self, filmed: Filmed) {
        if filmed.ending != VideoEnding::Asked {
            self.captures.video = false;
        }
        self.tell(match filmed {
            Filmed {
                saved: Saved::Done,
                ending: VideoEnding::TooLarge,
            } => Notice::VideoTooLarge,
            Filmed { saved, .. } => Notice::Saved(saved),
        });
    }

    pub(super) fn tell(&mut self, notice: Notice) {
        self.note(&notice);
        self.notices.tell(self.time_s, notice);
    }
}
