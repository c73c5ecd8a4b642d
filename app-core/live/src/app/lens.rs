//! Pictures of the lens on the card: the camera is darkened for a moment, so that little more than
//! lights is bright on it.
//!
//! Each picture is taken from the phone's present position: several constrain the distance of a
//! light. Alignment starts its search at the resulting lights.

use glam::DMat4;

use super::App;
use super::notice::{LensFailure, Notice};
use super::step::Step;
use app_alignment::probe::ProbeReport;
use app_scene::camera_frame::CameraFrame;
use app_scene::card::{card_from_lens, lens_shape};
use app_scene::scene::{Probe, ProbePicture};

/// Largest share of the held exposure at which a picture counts as dark.
const DARK: f64 = 0.125;
/// Time within which a camera must become dark, in seconds.
const PATIENCE_S: f64 = 2.0;
/// Number of kept pictures, the latest ones.
const N_PICTURES: usize = 8;

/// A dark picture that is awaited.
#[derive(Clone, Copy, Debug)]
struct Awaited {
    since_s: f64,
    /// Pose of the card when it was last visible: a dark picture does not show it.
    world_from_card: DMat4,
    /// Held exposure, in seconds at ISO 100.
    held_exposure: f64,
}

/// The pictures of the lens.
#[derive(Debug, Default)]
pub(super) struct Lens {
    awaited: Option<Awaited>,
    pictures: Vec<ProbePicture>,
}

impl Lens {
    /// Whether a dark picture is awaited.
    pub(super) fn is_awaited(&self) -> bool {
        self.awaited.is_some()
    }

    /// Ends the wait.
    pub(super) fn give_up(&mut self) {
        self.awaited = None;
    }

    /// The lens as a scene's probe.
    pub(super) fn probe(&self) -> Option<Probe> {
        (!self.pictures.is_empty()).then(|| Probe {
            shape: lens_shape(),
            pictures: self.pictures.clone(),
        })
    }

    /// Keeps a picture, and returns the number of lights that all pictures show together.
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
    /// Starts a photograph of the lens, for a person.
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

    /// Uses a frame as a picture of the lens, if one is awaited and the frame is dark.
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
