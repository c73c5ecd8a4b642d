//! Pictures of the lens that lies on the card: the camera is darkened for a moment, so that little but lights is bright on it.
//!
//! Each picture is from where the phone is: several tell how far away a light is. What they tell is where alignment looks first.

use glam::DMat4;

use super::App;
use super::notice::{LensFailure, Notice};
use super::step::Step;
use app_alignment::probe::ProbeReport;
use app_scene::camera_frame::CameraFrame;
use app_scene::card::{card_from_lens, lens_shape};
use app_scene::scene::{Probe, ProbePicture};

/// A picture is dark with no more than this part of the exposure that was held.
const DARK: f64 = 0.125;
/// A camera has so long to become dark, in seconds.
const PATIENCE_S: f64 = 2.0;
/// Pictures that are kept: the latest.
const N_PICTURES: usize = 8;

/// A dark picture that is waited for.
#[derive(Clone, Copy, Debug)]
struct Awaited {
    since_s: f64,
    /// Where the card was when it was last seen: a dark picture does not show it.
    world_from_card: DMat4,
    /// Seconds at ISO 100.
    held_exposure: f64,
}

/// What was taken of the lens.
#[derive(Debug, Default)]
pub(super) struct Lens {
    awaited: Option<Awaited>,
    pictures: Vec<ProbePicture>,
}

impl Lens {
    /// Whether a dark picture is waited for.
    pub(super) fn is_awaited(&self) -> bool {
        self.awaited.is_some()
    }

    /// Waits no longer.
    pub(super) fn give_up(&mut self) {
        self.awaited = None;
    }

    /// What a scene has of it.
    pub(super) fn probe(&self) -> Option<Probe> {
        (!self.pictures.is_empty()).then(|| Probe {
            shape: lens_shape(),
            pictures: self.pictures.clone(),
        })
    }

    /// Keeps a picture, and tells how many lights all show together.
    fn keep(&mut self, picture: ProbePicture) -> Result<usize, LensFailure> {
        let mut pictures = self.pictures.clone();
        pictures.push(picture);
        if pictures.len() > N_PICTURES {
            pictures.remove(0);
        }
        let probe = Probe {
            shape: lens_shape(),
            pictures,
        };
        let report = ProbeReport::of(&probe).map_err(|_| LensFailure::NotSeen)?;
        match report.lights.len() {
            _ if report.n_unseen > 0 => Err(LensFailure::NotSeen),
            0 => Err(LensFailure::NoLight),
            n_lights => {
                self.pictures = probe.pictures;
                Ok(n_lights)
            }
        }
    }
}

impl App {
    /// A person wants the lens to be photographed.
    pub(super) fn take_lens(&mut self) {
        let Some(frame) = self.latest.as_ref().filter(|_| self.step == Step::PlaceToy) else {
            return;
        };
        let Some(world_from_card) = frame.world_from_card else {
            return self.tell(Notice::LensFailed(LensFailure::NotSeen));
        };
        let Some(held_exposure) = frame.exposure.and_then(|exposure| exposure.amount()) else {
            return self.tell(Notice::LensFailed(LensFailure::NotDark));
        };
        self.lens.awaited = Some(Awaited {
            since_s: self.time_s,
            world_from_card,
            held_exposure,
        });
    }

    /// Takes a frame for a picture of the lens, where one is waited for and it is dark.
    pub(super) fn offer_lens(&mut self, frame: &CameraFrame) {
        let Some(awaited) = self.lens.awaited else { return };
        let amount = frame.exposure.and_then(|exposure| exposure.amount());
        let dark = amount.map(|amount| amount / awaited.held_exposure);
        let dark = dark.filter(|ratio| *ratio <= DARK).zip(frame.camera());
        let Some((exposure_ratio, camera)) = dark else {
            if self.time_s - awaited.since_s > PATIENCE_S {
                self.lens.give_up();
                self.tell(Notice::LensFailed(LensFailure::NotDark));
            }
            return;
        };
        self.lens.give_up();
        let taken = self.lens.keep(ProbePicture {
            image: frame.image.rgba().clone(),
            camera,
            world_from_probe: awaited.world_from_card * card_from_lens(),
            exposure_ratio,
        });
        self.tell(match taken {
            Ok(n_lights) => Notice::LensTaken(n_lights),
            Err(failure) => Notice::LensFailed(failure),
        });
    }
}
