//! One number that nobody knows well: the focal length, or the scale of the world, by toy and shadow together.
//!
//! A **focal length** that is off slides the toy along the view, since its outline keeps its size; its shadow then falls beside the
//! real one. No light makes up for that: where the toy stands on a receiver the shadow begins at its foot, wherever the light is.
//! The **scale** of a tracker's world is off where its metre is none: camera and receivers are then too far from one another for
//! the size of the toy, which slides along the view in the same way. It is the toy's transform that is scaled: so all else stays as it is
//! given, and one picture suffices, since the toy's size is known and its shadow tells how far it is from the receiver.
//!
//! So such numbers are tried, each with the pose that fits the outline best and the lights that fit the shadow best (`trials`),
//! until the shadow's loss is least (`optimum`, `minimum`): in a small picture, and around what that tells in a larger one.
//!
//! All else is held. A toy that is larger than its model, or a table that is nearer than listed, moves the shadow's foot as another
//! focal length does; the outline tells them apart by perspective. Where that fits worse, nothing is applied. By a scale no outline
//! changes: a focal length that is off is taken for one.

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

/// One number that is the same for all frames and plates of a scene, if any is asked for.
#[derive(Debug, Default)]
pub(super) struct Ratio {
    unknown: Option<Unknown>,
    /// In the latest view that it was looked for in.
    found: Option<RatioAlignment>,
}

impl Ratio {
    /// One that is looked for.
    pub(super) fn of(unknown: Unknown) -> Self {
        Self {
            unknown: Some(unknown),
            found: None,
        }
    }

    /// Whether it is still to be looked for.
    pub(super) fn is_open(&self) -> bool {
        self.unknown.is_some() && self.found.is_none_or(|found| !found.is_seen())
    }

    /// What was found.
    pub(super) fn report(&self, of: Unknown) -> Option<RatioAlignment> {
        self.found.filter(|_| self.unknown == Some(of))
    }

    /// That it was asked for and is not told.
    pub(super) fn warning(&self) -> Option<AlignmentWarning> {
        let found = self.found?;
        let is_told = matches!(found.outcome, RatioOutcome::Corrected | RatioOutcome::AsGiven);
        (!is_told).then_some(match self.unknown? {
            Unknown::FocalLength => AlignmentWarning::FocalLengthNotTold,
            Unknown::WorldScale => AlignmentWarning::WorldScaleNotTold,
            // Looked for before all else, and reported by itself.
            Unknown::Lens(_) => return None,
        })
    }

    /// Looks for it in a frame, and corrects the scene's plates; `lights` are about where the frame's are. Whether it is another.
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

    /// What was found of an unknown, where it is applied.
    fn applied(&self, of: Unknown) -> Option<f64> {
        let found = self.report(of).filter(RatioAlignment::is_applied);
        found.map(|found| found.ratio)
    }

    /// A camera as given, with the focal length that was found.
    pub(super) fn camera(&self, given: &Camera) -> Camera {
        let ratio = self.applied(Unknown::FocalLength);
        let camera = ratio.map(|ratio| given.with_focal_length(ratio));
        let possible = camera.filter(|camera| check::camera("camera", camera).is_ok());
        possible.unwrap_or(*given)
    }

    /// A pose of the toy as given, in the world's scale that was found.
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
        Ok(None) => return none(RatioOutcome::NotTold),
        Err(Unseen) => return none(RatioOutcome::Unseen),
    };
    let ratio = found.at.exp();
    let camera = input.camera.with_focal_length(ratio);
    if unknown == Unknown::FocalLength && check::camera("camera", &camera).is_err() {
        return none(RatioOutcome::NotTold);
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
