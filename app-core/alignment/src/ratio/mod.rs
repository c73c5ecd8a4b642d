//! Estimates one uncertain number, the focal length or the scale of the world, from toy and shadow
//! together.
//!
//! A wrong **focal length** shifts the toy along the view, since its outline keeps its size; its
//! shadow then falls beside the real one. No light can compensate that: if the toy stands on a
//! receiver, the shadow begins at its foot, wherever the light is. A wrong **scale** of a tracker's
//! world makes the distances between camera and receivers wrong relative to the size of the toy,
//! which is shifted along the view in the same way. The toy's transform is scaled: so all else
//! stays as given, and one picture suffices, since the toy's size is known and its shadow gives its
//! distance from the receiver.
//!
//! So such numbers are tried, each with the pose that fits the outline best and the lights that fit
//! the shadow best (`trials`), until the shadow's loss is least (`optimum`, `minimum`): in a small
//! picture, and then near that minimum in a larger one.
//!
//! All else is fixed. A toy larger than its model, or a table nearer than listed, moves the
//! shadow's foot like another focal length does; the perspective of the outline distinguishes them.
//! If that fits worse, nothing is applied. A scale changes no outline: a wrong focal length may be
//! mistaken for one.

mod lens;
mod minimum;
mod optimum;
mod trials;
mod unknown;

use glam::{DMat4, DVec3};

use super::report::{RatioAlignment, RatioOutcome};
use crate::warning::AlignmentWarning;
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Light, Scene, check};
use optimum::searched;
use trials::Unseen;

pub(super) use lens::find_lens;
pub(super) use unknown::Unknown;

/// Largest logarithm of a ratio.
const MOST: f64 = 0.04;

/// One number common to all frames and plates of a scene, if requested.
#[derive(Debug, Default)]
pub(super) struct Ratio {
    unknown: Option<Unknown>,
    /// The estimate in the latest view.
    found: Option<RatioAlignment>,
}

impl Ratio {
    /// An unknown number.
    pub(super) fn of(unknown: Unknown) -> Self {
        Self {
            unknown: Some(unknown),
            found: None,
        }
    }

    /// Whether it is still unknown.
    pub(super) fn is_open(&self) -> bool {
        self.unknown.is_some() && self.found.is_none_or(|found| !found.is_seen())
    }

    /// The estimate.
    pub(super) fn report(&self, of: Unknown) -> Option<RatioAlignment> {
        self.found.filter(|_| self.unknown == Some(of))
    }

    /// The warning that it was requested and is unconstrained.
    pub(super) fn warning(&self) -> Option<AlignmentWarning> {
        let found = self.found?;
        let is_constrained = matches!(found.outcome, RatioOutcome::Corrected | RatioOutcome::AsGiven);
        (!is_constrained).then_some(match self.unknown? {
            Unknown::FocalLength => AlignmentWarning::FocalLengthUnconstrained,
            Unknown::WorldScale => AlignmentWarning::WorldScaleUnconstrained,
            // Estimated before all else, and reported separately.
            Unknown::Lens(_) => return None,
        })
    }

    /// Estimates it in a frame, and corrects the scene's plates; `lights` are approximate. Returns
    /// whether the number changed.
    pub(super) fn find(&mut self, scene: &mut Scene, input: &FrameInput, lights: &[Light]) -> bool {
        let Some(unknown) = self.unknown else {
            return false;
        };
        let found = find(unknown, scene, input, lights);
        self.found = Some(found);
        for plate in &mut scene.plates {
            plate.camera = self.camera(&plate.camera);
        }
        found.is_applied()
    }

    /// The applied estimate of an unknown, if any.
    fn applied(&self, of: Unknown) -> Option<f64> {
        let found = self.report(of).filter(RatioAlignment::is_applied);
        found.map(|found| found.ratio)
    }

    /// A given camera with the estimated focal length.
    pub(super) fn camera(&self, given: &Camera) -> Camera {
        let ratio = self.applied(Unknown::FocalLength);
        let camera = ratio.map(|ratio| given.with_focal_length(ratio));
        let possible = camera.filter(|camera| check::camera("camera", camera).is_ok());
        possible.unwrap_or(*given)
    }

    /// A given pose of the toy, in the estimated scale of the world.
    pub(super) fn pose(&self, given: &DMat4) -> DMat4 {
        let ratio = self.applied(Unknown::WorldScale);
        let pose = ratio.map(|ratio| *given * DMat4::from_scale(DVec3::splat(ratio)));
        let possible = pose.filter(|pose| check::similarity(pose.to_cols_array()).is_ok());
        possible.unwrap_or(*given)
    }
}

fn find(unknown: Unknown, scene: &Scene, input: &FrameInput, lights: &[Light]) -> RatioAlignment {
    let found = match searched(unknown, MOST, (scene, input, lights)) {
        Ok(Some(found)) => found,
        Ok(None) => return none(RatioOutcome::Unconstrained),
        Err(Unseen) => return none(RatioOutcome::Unseen),
    };
    let ratio = found.at.exp();
    let camera = input.camera.with_focal_length(ratio);
    if unknown == Unknown::FocalLength && check::camera("camera", &camera).is_err() {
        return none(RatioOutcome::Unconstrained);
    }
    RatioAlignment {
        outcome: found.outcome,
        ratio,
        deviation: found.deviation,
        errors: Some(found.errors),
    }
}

fn none(outcome: RatioOutcome) -> RatioAlignment {
    RatioAlignment {
        outcome,
        ratio: 1.0,
        deviation: f64::INFINITY,
        errors: None,
    }
}
