//! Processing of a camera frame.

use std::sync::Arc;

use super::App;
use super::aligning::{AlignedJob, Place, Verdict};
use super::event::{PlatformCommand, ShellCommand, Thermal, WorkCommand};
use super::ghost::Ghost;
use super::notice::Notice;
use super::step::{Cause, Step};
use super::table::{as_reported_now, beside};
use super::watching::WatchedJob;
use app_scene::camera_frame::{Arrival, CameraFrame, FoundPlane, Tracking};
use app_scene::frame::FrameInput;
use app_scene::scene::{Receiver, Scene, Surface};

/// Time after which relocalisation is given up if nothing was placed yet.
const RELOCALISING_S: f64 = 10.0;

impl App {
    pub(super) fn frame(&mut self, frame: CameraFrame, commands: &mut Vec<ShellCommand>) {
        if !self.commanded.is_tracking() {
            // This frame was on its way when the camera was paused.
            return;
        }
        let arrival = self.arrivals.arrive(frame.stamp);
        if !arrival.is_taken() {
            return;
        }
        let elapsed_s = arrival.counted_s();
        self.time_s += elapsed_s;
        if self.is_of_another_place(&frame, arrival) {
            self.go(Cause::WorldLost);
            self.tell(Notice::WorldLost);
        }
        self.platform.tracking = frame.tracking;
        self.follow_relocalising(elapsed_s);
        let camera = frame.camera();
        if camera.is_some() {
            self.camera = camera;
        }
        let frame = Arc::new(frame.with_maps_of_its_shape());
        self.latest = Some(Arc::clone(&frame));
        self.follow_table(&frame);
        self.place_check(&frame);
        if let Some(place) = &mut self.place {
            place.follow_anchor(&frame.anchors, arrival.filtered_s());
        }
        self.follow_reticle(commands);
        self.follow_scan(&frame);
        match self.step {
            Step::PlaceToy => {
                self.offer_lens(&frame);
                self.search(camera.is_some(), elapsed_s, commands);
            }
            Step::TakePlate => self.offer_plate(&frame, elapsed_s, commands),
            Step::Align | Step::Play => {
                self.align(camera.is_some(), commands);
                self.watch(camera.is_some(), commands);
            }
            _ => {}
        }
        self.playback
            .advance(if self.step == Step::Play { elapsed_s } else { 0.0 });
        let is_known = self.step == Step::Play
            && camera.is_some()
            && self.platform.thermal < Thermal::Critical
            && self.place.as_ref().is_some_and(Place::is_known);
        self.fade.step(elapsed_s, is_known);
        self.record(&frame);
    }

    /// Restarts a tracker that tries to relocalise before anything was placed: in another room it
    /// would never succeed.
    fn follow_relocalising(&mut self, elapsed_s: f64) {
        let is_in_vain = self.platform.tracking == Tracking::Relocalising && self.table.is_none();
        self.relocalising_s = if is_in_vain {
            self.relocalising_s + elapsed_s
        } else {
            0.0
        };
        if self.relocalising_s >= RELOCALISING_S {
            self.relocalising_s = 0.0;
            self.start_over();
        }
    }

    /// Whether earlier poses or pixels are meaningless for a frame.
    fn is_of_another_place(&self, frame: &CameraFrame, arrival: Arrival) -> bool {
        let is_new_world = arrival == Arrival::NewWorld;
        let is_other_size = self
            .plates
            .iter()
            .any(|plate| frame.image.size_px() != [plate.image.width_px, plate.image.height_px]);
        let is_other_place = self
            .place
            .as_ref()
            .is_some_and(|place| frame.image.size_px() != [place.scene.width_px, place.scene.height_px]);
        self.table.is_some() && (is_new_world || is_other_size || is_other_place)
    }

    /// Adopts the tracker's corrections of the table until something is placed on it.
    fn follow_table(&mut self, frame: &CameraFrame) {
        let Some(table) = &mut self.table else { return };
        let same = as_reported_now(table, frame);
        if let Some(plane) = same.filter(|_| self.place.is_none() && self.plates.is_empty()) {
            if let Some(ghost) = &mut self.ghost {
                ghost.follow(&plane);
            }
            *table = plane;
        }
    }

    /// A scene of the table, the plates and the ghost; without a ghost, the toy is in the middle of
    /// the table.
    pub(super) fn placed_scene(&self) -> Option<Scene> {
        let (table, latest) = (self.table.as_ref()?, self.latest.as_ref()?);
        let ghost = match &self.ghost {
            Some(ghost) => *ghost,
            None => Ghost::standing(&self.toy, table, &table.world_from_plane)?,
        };
        let others = beside(table, &latest.planes, &ghost.world_from_object(), &self.toy);
        let receiver = |(index, plane): (usize, &FoundPlane)| Receiver {
            name: if index == 0 {
                "table".to_owned()
            } else {
                format!("plane {index}")
            },
            world_from_plane: plane.world_from_plane,
            half_extent_m: plane.half_extent_m,
            surface: Surface::Textured,
        };
        let scene = Scene::new(
            latest.image.size_px(),
            Arc::clone(&self.toy),
            ghost.world_from_object(),
            std::iter::once(table)
                .chain(others)
                .enumerate()
                .map(receiver)
                .collect(),
        );
        Some(scene.with_plates(self.plates.clone()))
    }

    /// Makes a scene of the table, the plates and the ghost.
    pub(super) fn place_toy(&mut self) {
        let Some(scene) = self.placed_scene() else {
            return;
        };
        let scene = scene.with_probe(self.lens.probe());
        self.n_places += 1;
        self.wants_anchor = true;
        self.place = Some(Place::new(self.n_places, scene));
    }

    fn align(&mut self, is_trusted: bool, commands: &mut Vec<ShellCommand>) {
        if !is_trusted {
            return;
        }
        let input = self.input(1.0);
        if let (Some(place), Some(input)) = (&mut self.place, input) {
            let job = place.job(self.time_s, input);
            if std::mem::take(&mut self.wants_anchor) {
                let (id, world_from_anchor) = place.anchor();
                commands.push(
                    PlatformCommand::HoldAnchor {
                        id,
                        world_from_anchor,
                    }
                    .into(),
                );
            }
            commands.extend(job.map(|job| WorkCommand::Align(Box::new(job)).into()));
        }
    }

    /// Searches for things, unless the device is warm.
    fn watch(&mut self, is_trusted: bool, commands: &mut Vec<ShellCommand>) {
        if !is_trusted || self.step != Step::Play || self.platform.thermal >= Thermal::Serious {
            return;
        }
        let input = self.input(1.0);
        if let (Some(place), Some(input)) = (&mut self.place, input) {
            let job = place.watch_job(self.time_s, input);
            commands.extend(job.map(|job| WorkCommand::Watch(Box::new(job)).into()));
        }
    }

    pub(super) fn watched(&mut self, done: WatchedJob) {
        if let Some(place) = &mut self.place {
            place.take_watched(done);
        }
    }

    /// The frame's exposure relative to that of the plates; 1 if the platform does not report it.
    pub(super) fn exposure_of(&self, frame: &CameraFrame) -> f64 {
        let amount = frame.exposure.and_then(|exposure| exposure.amount());
        match (amount, self.plate_exposure) {
            (Some(amount), Some(plate)) => amount / plate,
            _ => 1.0,
        }
    }

    /// The latest frame with the shown moment, with the tracker's pose.
    pub(super) fn input(&self, effect: f64) -> Option<FrameInput> {
        let (latest, place) = (self.latest.as_ref()?, self.place.as_ref()?);
        let camera = latest.camera().or(self.camera)?;
        // A platform's estimate may be invalid; without it, nothing else of the frame is lost.
        let estimate = latest.light_estimate;
        let estimate = estimate.filter(|estimate| estimate.check("light_estimate").is_ok());
        let input = FrameInput::new(latest.image.clone(), camera, place.scene.world_from_object)
            .with_exposure(self.exposure_of(latest))
            .with_light_estimate(estimate)
            .with_people(latest.people.clone())
            .with_depth(latest.depth.clone())
            .with_shown_pose(self.playback.pose())
            .with_effect(effect);
        Some(input)
    }

    pub(super) fn aligned(&mut self, done: AlignedJob, commands: &mut Vec<ShellCommand>) {
        let Some(place) = &mut self.place else { return };
        if let Some(verdict) = place.take(done) {
            if let (Some(recorder), Verdict::Found { .. }) = (&self.recorder, &verdict) {
                place.tell(recorder);
            }
            self.note(&verdict);
            self.judge(verdict, commands);
        }
    }

    fn judge(&mut self, verdict: Verdict, commands: &mut Vec<ShellCommand>) {
        if self.step != Step::Align {
            return;
        }
        if let Verdict::Found {
            outline_px: Some(_), ..
        } = verdict
        {
            self.knock_for_toy(commands);
            return self.go(Cause::ToyFound);
        }
        self.go(Cause::ToyMissed);
        self.tell(Notice::ToyMissed(verdict));
    }
}
