//! The focal length, by toy and shadow together.
//!
//! A focal length that is off slides the toy along the view, since its outline keeps its size; its shadow then falls beside the
//! real one. No light makes up for that: where the toy stands on a receiver the shadow begins at its foot, wherever the light is.
//! So focal lengths are tried, each with the pose that fits the outline best and the lights that fit the shadow best (`trials`),
//! until the shadow's loss is least (`minimum`): in a small picture, and around what that tells in a larger one.
//!
//! The camera's pose, the receivers and the size of the toy are held. A toy that is larger than its model, or a table that is nearer
//! than listed, moves the shadow's foot as another focal length does; the outline tells them apart by perspective. Where that fits
//! worse, nothing is applied.

mod minimum;
mod trials;

use super::report::{FocalLengthAlignment, FocalLengthOutcome};
use crate::frame::FrameInput;
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
/// A focal length is applied where the loss falls to less than this part of that of the given one: as lights are.
const GAIN: f64 = 0.96;
/// A logarithm whose deviation is larger is not told.
const MOST_DEVIATION: f64 = 0.004;
/// A smaller one does not show: a sixth of a millimetre along the view at the distance of an arm.
const LEAST: f64 = 5e-4;
/// Deviations that it must differ by.
const TOLD: f64 = 2.0;
/// What the outline's distance may rise to, over that with the focal length given.
const WORSE_OUTLINE: f64 = 1.015;

/// The focal length of the frames and plates of one scene.
#[derive(Debug, Default)]
pub(super) struct FocalLength {
    is_unknown: bool,
    /// In the latest view that it was looked for in.
    found: Option<FocalLengthAlignment>,
}

impl FocalLength {
    /// One that is looked for.
    pub(super) fn unknown() -> Self {
        Self {
            is_unknown: true,
            found: None,
        }
    }

    /// Whether it is still to be looked for.
    pub(super) fn is_open(&self) -> bool {
        self.is_unknown && self.found.is_none_or(|found| !found.is_seen())
    }

    /// What was found.
    pub(super) fn report(&self) -> Option<FocalLengthAlignment> {
        self.found
    }

    /// Looks for it in a frame, and corrects the scene's plates; `lights` are about where the frame's are. Whether it is another.
    pub(super) fn find(&mut self, scene: &mut Scene, input: &FrameInput, lights: &[Light]) -> bool {
        let found = find(scene, input, lights);
        self.found = Some(found);
        for plate in &mut scene.plates {
            plate.camera = self.corrected(&plate.camera);
        }
        found.is_applied()
    }

    /// A camera as given, with the focal length that was found.
    pub(super) fn corrected(&self, given: &Camera) -> Camera {
        let found = self.found.filter(FocalLengthAlignment::is_applied);
        let camera = found.map(|found| given.with_focal_length(found.ratio));
        let possible = camera.filter(|camera| check::camera("camera", camera).is_ok());
        possible.unwrap_or(*given)
    }
}

fn find(scene: &Scene, input: &FrameInput, lights: &[Light]) -> FocalLengthAlignment {
    let mut report = searched(scene, input, lights).unwrap_or_else(|Unseen| none(FocalLengthOutcome::Unseen));
    let camera = input.camera.with_focal_length(report.ratio);
    if check::camera("camera", &camera).is_err() {
        report = none(FocalLengthOutcome::NotTold);
    }
    report
}

fn searched(scene: &Scene, input: &FrameInput, lights: &[Light]) -> Result<FocalLengthAlignment, Unseen> {
    let mut trials = Trials::new(scene, input, lights)?;
    let Some(about) = least(COARSE, |at| Ok(trials.at(at)?.loss))? else {
        return Ok(none(FocalLengthOutcome::NotTold));
    };
    trials.enlarge()?;
    let around = Span {
        start: about.at,
        ..FINE
    };
    let Some(found) = least(around, |at| Ok(trials.at(at)?.loss))? else {
        return Ok(none(FocalLengthOutcome::NotTold));
    };
    let given = trials.at(0.0)?;
    let outline_px = trials.outline_px(found.at).ok_or(Unseen)?;
    Ok(FocalLengthAlignment {
        outcome: outcome(&found, &given, outline_px),
        ratio: found.at.exp(),
        deviation: deviation(&found),
        errors: Some([given.loss, found.loss]),
    })
}

fn outcome(found: &Parabola, given: &Trial, outline_px: f64) -> FocalLengthOutcome {
    let deviation = deviation(found);
    let is_as_given = found.at.abs() < LEAST.max(TOLD * deviation) || found.loss > GAIN * given.loss;
    if deviation > MOST_DEVIATION {
        FocalLengthOutcome::NotTold
    } else if is_as_given {
        FocalLengthOutcome::AsGiven
    } else if outline_px > WORSE_OUTLINE * given.outline_px {
        FocalLengthOutcome::OutlineDisagrees
    } else {
        FocalLengthOutcome::Corrected
    }
}

fn none(outcome: FocalLengthOutcome) -> FocalLengthAlignment {
    FocalLengthAlignment {
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
