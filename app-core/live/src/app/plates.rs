//! The photograph of the empty place, made on another thread: its pictures are decoded there.

use app_alignment::plate_taker::{PlateShot, PlateStep, PlateTaker};
use app_scene::camera_frame::CameraFrame;
use app_scene::scene::Plate;

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

impl PlatedJob {
    /// The plate, and its exposure; none while it grows.
    pub(super) fn plate(&self) -> Option<(Plate, Option<f64>)> {
        match &self.step {
            PlateStep::Taken { plate, .. } => Some((plate.clone(), self.exposure)),
            _ => None,
        }
    }
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

    /// A shot of `frame`, if none is looked at.
    pub(super) fn job(&mut self, frame: &CameraFrame, elapsed_s: f64) -> Option<PlateJob> {
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

    /// Takes what came of a shot; whether it was of this plate.
    pub(super) fn take(&mut self, done: PlatedJob) -> bool {
        if done.number != self.number {
            return false;
        }
        self.taker = Some(done.taker);
        self.step = Some(done.step);
        true
    }
}
