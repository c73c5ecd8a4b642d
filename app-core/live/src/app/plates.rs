//! The photograph of the empty place, made on another thread: its pictures are decoded there.

use super::App;
use super::event::{ShellCommand, WorkCommand};
use super::step::{Cause, Step};
use app_alignment::plate_taker::{PlateShot, PlateStep, PlateTaker};
use app_scene::camera_frame::CameraFrame;

/// A picture that may become part of a plate, for another thread.
#[derive(Debug)]
pub struct PlateJob {
    number: u64,
    taker: PlateTaker,
    shot: PlateShot,
    exposure: Option<f64>,
}

impl PlateJob {
    /// Looks at the picture; some hundredths of a second.
    #[must_use]
    pub fn run(mut self) -> PlatedJob {
        let step = self.taker.offer(&self.shot);
        PlatedJob {
            number: self.number,
            taker: self.taker,
            step,
            exposure: self.exposure,
        }
    }
}

/// What came of it.
#[derive(Debug)]
pub struct PlatedJob {
    number: u64,
    taker: PlateTaker,
    step: PlateStep,
    exposure: Option<f64>,
}

/// A plate that is being taken.
#[derive(Debug, Default)]
pub(super) struct Plating {
    /// Counts plates: results of another are not taken.
    number: u64,
    /// None while it is at work.
    taker: Option<PlateTaker>,
    /// Since the shot before.
    waited_s: f64,
    pub(super) step: Option<PlateStep>,
}

impl Plating {
    /// Another plate is to be taken.
    pub(super) fn begin(&mut self) {
        *self = Self {
            number: self.number + 1,
            taker: Some(PlateTaker::default()),
            ..Self::default()
        };
    }

    fn job(&mut self, frame: &CameraFrame, elapsed_s: f64) -> Option<PlateJob> {
        self.waited_s += elapsed_s;
        let taker = self.taker.take()?;
        Some(PlateJob {
            number: self.number,
            taker,
            shot: PlateShot {
                // A platform has few pictures to lend.
                image: frame.image.kept(),
                camera: frame.camera(),
                elapsed_s: std::mem::take(&mut self.waited_s),
            },
            exposure: frame.exposure.and_then(|exposure| exposure.amount()),
        })
    }
}

impl App {
    pub(super) fn offer_plate(
        &mut self,
        frame: &CameraFrame,
        elapsed_s: f64,
        commands: &mut Vec<ShellCommand>,
    ) {
        let job = self.plating.job(frame, elapsed_s);
        commands.extend(job.map(|job| WorkCommand::Plate(Box::new(job)).into()));
    }

    /// Takes what came of a shot; none if its thread did not come to an end.
    pub(super) fn plated(&mut self, done: Option<Box<PlatedJob>>) {
        let Some(done) = done else {
            // Another thread may have more luck.
            return self.plating.begin();
        };
        if done.number != self.plating.number || self.step != Step::TakePlate {
            return;
        }
        self.plating.taker = Some(done.taker);
        if let PlateStep::Taken { plate, .. } = &done.step {
            self.plates.push(plate.clone());
            self.plate_exposure = done.exposure;
            self.go(Cause::PlateTaken);
        }
        self.plating.step = Some(done.step);
    }
}
