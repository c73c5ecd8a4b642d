//! The photograph of the empty place, made on another thread, which also decodes its pictures.

use super::aligning::N_DEAD;
use app_alignment::plate_taker::{PlateShot, PlateStep, PlateTaker};
use app_scene::camera_frame::CameraFrame;
use app_scene::scene::Plate;

/// A picture for a plate, as a job for another thread.
#[derive(Debug)]
pub struct PlateJob {
    number: u64,
    taker: PlateTaker,
    shot: PlateShot,
    exposure: Option<f64>,
}

impl PlateJob {
    /// Examines the picture; some hundredths of a second.
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

/// The result of a plate job.
#[derive(Debug)]
pub struct PlatedJob {
    number: u64,
    taker: PlateTaker,
    step: PlateStep,
    exposure: Option<f64>,
}

/// A plate in progress.
#[derive(Debug, Default)]
pub(super) struct Plating {
    /// Number of the plate: results of another plate are dropped.
    number: u64,
    /// `None` while it runs on its thread.
    taker: Option<PlateTaker>,
    /// Seconds since the previous shot.
    waited_s: f64,
    /// Number of threads of this plate that did not end normally.
    n_dead: u32,
    pub(super) step: Option<PlateStep>,
}

impl PlatedJob {
    /// The plate and its exposure; `None` while it is in progress.
    pub(super) fn plate(&self) -> Option<(Plate, Option<f64>)> {
        match &self.step {
            PlateStep::Taken { plate, .. } => Some((plate.clone(), self.exposure)),
            _ => None,
        }
    }
}

impl Plating {
    /// Starts another plate.
    pub(super) fn begin(&mut self) {
        *self = Self {
            number: self.number + 1,
            taker: Some(PlateTaker::default()),
            ..Self::default()
        };
    }

    /// Starts anew after a thread that did not end normally; returns false if that is in vain.
    pub(super) fn begins_after_death(&mut self) -> bool {
        let n_dead = self.n_dead + 1;
        self.begin();
        self.n_dead = n_dead;
        n_dead < N_DEAD
    }

    /// A shot of `frame`, if no other is being examined.
    pub(super) fn job(&mut self, frame: &CameraFrame, elapsed_s: f64) -> Option<PlateJob> {
        self.waited_s += elapsed_s;
        let taker = self.taker.take()?;
        Some(PlateJob {
            number: self.number,
            taker,
            shot: PlateShot {
                // A platform lends only a few pictures.
                image: frame.image.kept(),
                camera: frame.camera(),
                elapsed_s: std::mem::take(&mut self.waited_s),
            },
            exposure: frame.exposure.and_then(|exposure| exposure.amount()),
        })
    }

    /// Adopts the result of a shot. Returns whether it belonged to this plate.
    pub(super) fn take(&mut self, done: PlatedJob) -> bool {
        if done.number != self.number {
            return false;
        }
        self.taker = Some(done.taker);
        self.step = Some(done.step);
        true
    }
}
