//! The toy's pose and the plate: the app's use of results from threads.

use glam::DVec3;

use super::App;
use super::event::{PlatformCommand, ShellCommand, WorkCommand};
use super::ghost::Ghost;
use super::notice::Notice;
use super::plates::PlatedJob;
use super::search::{Placing, SearchedJob};
use super::step::{Cause, Step};
use app_scene::camera_frame::{Anchor, CameraFrame};
use app_scene::frame::FrameInput;

/// Distance in metres from its earlier place at which a toy that the platform recognises counts as
/// moved.
const MOVED_M: f64 = 0.03;

impl App {
    /// The state of the question about the toy's place; in [`Step::PlaceToy`].
    #[must_use]
    pub fn placing(&self) -> Placing {
        match self.search.placing() {
            // Only a tap can give the place.
            Placing::ByHand if self.ghost.is_none() => Placing::Waiting { is_long: true },
            placing => placing,
        }
    }

    /// Whether the ghost has a meaningful pose.
    pub(super) fn shows_ghost(&self) -> bool {
        match self.step {
            Step::Align => true,
            Step::PlaceToy => matches!(self.placing(), Placing::Asked { .. } | Placing::ByHand),
            _ => false,
        }
    }

    /// Starts the search, in all turns, at the place where the platform recognises the toy by its
    /// scan or sees it moved: the scan has axes of its own.
    pub(super) fn follow_scan(&mut self, frame: &CameraFrame) {
        let own = frame.anchors.iter().rfind(|anchor| anchor.id == Anchor::OF_TOY);
        let (Some(own), Some(table)) = (own, &self.table) else {
            return;
        };
        let at = own.world_from_anchor.w_axis.truncate();
        let is_elsewhere = self.scanned_at.is_none_or(|before| before.distance(at) > MOVED_M);
        let is_lost = self.step == Step::Play && self.place.as_ref().is_some_and(|place| !place.is_known());
        if !is_elsewhere || !(self.step == Step::PlaceToy || is_lost) {
            return;
        }
        let Some(ghost) = Ghost::standing(&self.toy, table, &own.world_from_anchor) else {
            return;
        };
        self.scanned_at = Some(at);
        self.note(&("the platform recognises the toy", at));
        if is_lost {
            self.go(Cause::Replace);
        }
        self.ghost = Some(ghost);
        self.look_again(at);
    }

    /// Searches at a point of the world; the ghost is shown until a better pose is known.
    pub(super) fn look_again(&mut self, at: DVec3) {
        let ghost = self.ghost.as_ref().map(Ghost::world_from_object);
        self.search.look_again(at, ghost);
        self.owes_knock = true;
    }

    /// Gives one haptic pulse for a toy that was found.
    pub(super) fn knock_for_toy(&mut self, commands: &mut Vec<ShellCommand>) {
        if std::mem::take(&mut self.owes_knock) {
            commands.push(PlatformCommand::Knock.into());
        }
    }

    pub(super) fn search(&mut self, is_trusted: bool, elapsed_s: f64, commands: &mut Vec<ShellCommand>) {
        let mut search = std::mem::take(&mut self.search);
        let job = search.job(elapsed_s, || {
            let scene = self
                .placed_scene()
                .filter(|_| is_trusted && !self.lens.is_awaited())?;
            let latest = self.latest.as_ref()?;
            let camera = latest.camera()?;
            // The job runs for some tenths of a second, and a platform lends only a few pictures.
            let input = FrameInput::new(latest.image.kept(), camera, scene.world_from_object);
            Some((scene, input.with_exposure(self.exposure_of(latest))))
        });
        self.search = search;
        commands.extend(job.map(|job| WorkCommand::Search(Box::new(job)).into()));
    }

    /// Adopts the result of a part of the search; `None` if its thread did not end normally.
    pub(super) fn searched(&mut self, done: Option<Box<SearchedJob>>, commands: &mut Vec<ShellCommand>) {
        let Some(done) = done else {
            return self.search.die();
        };
        let is_better = self.search.take(*done);
        if self.step != Step::PlaceToy {
            return;
        }
        match self.search.placing() {
            Placing::Asked { is_searching: false } => self.knock_for_toy(commands),
            // Also after a false alarm.
            Placing::Waiting { .. } => self.owes_knock = true,
            _ => {}
        }
        if !is_better {
            return;
        }
        let (Some(best), Some(table)) = (self.search.best, &self.table) else {
            return;
        };
        if let Some(ghost) = Ghost::standing(&self.toy, table, &best.world_from_object) {
            self.ghost = Some(ghost);
        }
        self.note(&("search", best.outline_px));
    }

    pub(super) fn offer_plate(
        &mut self,
        frame: &CameraFrame,
        elapsed_s: f64,
        commands: &mut Vec<ShellCommand>,
    ) {
        let job = self.plating.job(frame, elapsed_s);
        commands.extend(job.map(|job| WorkCommand::Plate(Box::new(job)).into()));
    }

    /// Handles a plate's thread that did not end normally. Another one may succeed, but not for
    /// ever: then it goes on without a plate.
    fn plate_died(&mut self) {
        if self.plating.begins_after_death() {
            return;
        }
        self.go(Cause::PlateSkipped);
        self.tell(Notice::NoPlate);
    }

    /// Adopts the result of a shot; `None` if its thread did not end normally.
    pub(super) fn plated(&mut self, done: Option<Box<PlatedJob>>) {
        let Some(done) = done else {
            return self.plate_died();
        };
        let plate = done.plate();
        if !self.plating.take(*done) || self.step != Step::TakePlate {
            return;
        }
        if let Some((plate, exposure)) = plate {
            self.plates.push(plate);
            self.plate_exposure = exposure;
            self.go(Cause::PlateTaken);
        }
    }
}
