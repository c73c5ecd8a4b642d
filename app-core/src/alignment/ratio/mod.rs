//! One number that nobody knows well: the focal length, or the scale of the world, by toy and shadow together.
//!
//! A **focal length** that is off slides the toy along the view, since its outline keeps its size; its shadow then falls beside the
//! real one. No light makes up for that: where the toy stands on a receiver the shadow begins at its foot, wherever the light is.
//! The **scale** of a tracker's world is off where its metre is none: camera and receivers are then too far from one another for
//! the size of the toy, which slides along the view in the same way. It is the toy's transform that is scaled: so all else stays as it is
//! given, and one picture suffices, since the toy's size is known and its shadow tells how far it is from the receiver.
//!
//! So such numbers are tried, each with the pose that fits the outline best and the lights that fit the shadow best (`trials`),
//! until the shadow's loss is least (`minimum`): in a small picture, and around what that tells in a larger one.
//!
//! All else is held. A toy that is larger than its model, or a table that is nearer than listed, moves the shadow's foot as another
//! focal length does; the outline tells them apart by perspective. Where that fits worse, nothing is applied. By a scale no outline
//! changes: a focal length that is off is taken for one.

mod minimum;
mod trials;

use glam::{DMat4, DVec3};

use super::report::{RatioAlignment, RatioOutcome};
use crate::frame::{FrameInput, Warning};
use crate::scene::{Camera, Light, Scene, check};
use minimum::{Parabola, Span, least};
use trials::{Trial, Trials, Unseen};

/// Logarithms of ratios that are tried first: how far apart, and the largest.
const COARSE: Span = Span {
    start: 0.0,
    step: 0.01,
    most: 0.04,
    n_finer: 0,
};
/// The same in the larger picture: where the loss is nearly a parabola.
const FINE: Span = Span {
    step: 0.002,
    n_finer: 1,
    ..COARSE
};
/// A ratio is applied where the loss falls to less than this part of that of the given one: as lights are.
const GAIN: f64 = 0.96;
/// A logarithm whose deviation is larger is not told.
const MOST_DEVIATION: f64 = 0.004;
/// A smaller one does not show: a sixth of a millimetre along the view at the distance of an arm.
const LEAST: f64 = 5e-4;
/// Deviations that it must differ by.
const TOLD: f64 = 2.0;
/// What the outline's distance may rise to, over that with what was given.
const WORSE_OUTLINE: f64 = 1.015;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknown {
    FocalLength,
    WorldScale,
}

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
    pub(super) fn warning(&self) -> Option<Warning> {
        let found = self.found?;
        let is_told = matches!(found.outcome, RatioOutcome::Corrected | RatioOutcome::AsGiven);
        (!is_told).then_some(match self.unknown? {
            Unknown::FocalLength => Warning::FocalLengthNotTold,
            Unknown::WorldScale => Warning::WorldScaleNotTold,
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
    let report = searched(unknown, scene, input, lights).unwrap_or_else(|Unseen| none(RatioOutcome::Unseen));
    let camera = input.camera.with_focal_length(report.ratio);
    if unknown == Unknown::FocalLength && check::camera("camera", &camera).is_err() {
        none(RatioOutcome::NotTold)
    } else {
        report
    }
}

fn searched(
    unknown: Unknown,
    scene: &Scene,
    input: &FrameInput,
    lights: &[Light],
) -> Result<RatioAlignment, Unseen> {
    let mut trials = Trials::new(unknown, scene, input, lights)?;
    let Some(about) = least(COARSE, |at| Ok(trials.at(at)?.loss))? else {
        return Ok(none(RatioOutcome::NotTold));
    };
    trials.enlarge()?;
    let around = Span {
        start: about.at,
        ..FINE
    };
    let Some(found) = least(around, |at| Ok(trials.at(at)?.loss))? else {
        return Ok(none(RatioOutcome::NotTold));
    };
    let given = trials.at(0.0)?;
    let outline_px = trials.outline_px(found.at).ok_or(Unseen)?;
    Ok(RatioAlignment {
        outcome: outcome(&found, &given, outline_px),
        ratio: found.at.exp(),
        deviation: deviation(&found),
        errors: Some([given.loss, found.loss]),
    })
}

fn outcome(found: &Parabola, given: &Trial, outline_px: f64) -> RatioOutcome {
    let deviation = deviation(found);
    let is_as_given = found.at.abs() < LEAST.max(TOLD * deviation) || found.loss > GAIN * given.loss;
    if deviation > MOST_DEVIATION {
        RatioOutcome::NotTold
    } else if is_as_given {
        RatioOutcome::AsGiven
    } else if outline_px > WORSE_OUTLINE * given.outline_px {
        RatioOutcome::OutlineDisagrees
    } else {
        RatioOutcome::Corrected
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

/// How far the logarithm may be off before the loss has risen by what errors of the model are taken for: noise alone would promise ten
/// times as much.
fn deviation(found: &Parabola) -> f64 {
    ((1.0 / GAIN - 1.0) * found.loss / found.bend).sqrt()
}
