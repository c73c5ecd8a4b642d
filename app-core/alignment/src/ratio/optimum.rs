//! The optimal value of an unknown: in a small picture, and then near it in a larger one.

use super::minimum::{Parabola, Span, least};
use super::trials::{Trial, Trials, Unseen};
use super::unknown::Unknown;
use crate::report::RatioOutcome;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, Scene};

/// Spacing of the first trials, in logarithms of ratios, or in the lens's distortion at the
/// farthest corner. The caller gives the largest.
const COARSE: Span = Span {
    start: 0.0,
    step: 0.01,
    most: 0.0,
    n_finer: 0,
};
/// The same in the larger picture, in which the loss is nearly a parabola.
const FINE: Span = Span {
    step: 0.002,
    n_finer: 1,
    ..COARSE
};
/// A ratio is applied if the loss falls to less than this fraction of the given one's, as for
/// lights.
const GAIN: f64 = 0.96;
/// Largest standard deviation of a constrained logarithm.
const MOST_DEVIATION: f64 = 0.004;
/// The same for the distortion at the farthest corner: at toy and shadow, it is a fifth of that.
const MOST_LENS_DEVIATION: f64 = 0.02;
/// Smallest visible change: a sixth of a millimetre along the view at arm's length.
const LEAST: f64 = 5e-4;
/// Significance of a change, in standard deviations.
const SIGNIFICANT: f64 = 2.0;
/// Largest rise of the outline's distance, over that with the given value.
const WORSE_OUTLINE: f64 = 1.015;

/// The number of least loss.
pub(super) struct Found {
    pub(super) at: f64,
    pub(super) outcome: RatioOutcome,
    pub(super) deviation: f64,
    /// Errors with the given and with the estimated value.
    pub(super) errors: [f64; 2],
}

/// Minimises the loss up to a largest number, in the small picture, and near that in the larger
/// one; `None` if either has no minimum.
pub(super) fn searched(
    unknown: Unknown,
    most: f64,
    (scene, input, lights): (&Scene, &FrameInput, &[Light]),
) -> Result<Option<Found>, Unseen> {
    let mut trials = Trials::new(unknown, scene, input, lights)?;
    let Some(about) = least(Span { most, ..COARSE }, |at| Ok(trials.at(at)?.loss))? else {
        return Ok(None);
    };
    trials.enlarge()?;
    let around = Span {
        start: about.at,
        most,
        ..FINE
    };
    let Some(found) = least(around, |at| Ok(trials.at(at)?.loss))? else {
        return Ok(None);
    };
    let given = trials.at(0.0)?;
    let outline_px = trials.outline_px(found.at).ok_or(Unseen)?;
    Ok(Some(Found {
        at: found.at,
        outcome: outcome(&found, &given, (outline_px, unknown.most_deviation())),
        deviation: deviation(&found),
        errors: [given.loss, found.loss],
    }))
}

fn outcome(found: &Parabola, given: &Trial, (outline_px, most_deviation): (f64, f64)) -> RatioOutcome {
    let deviation = deviation(found);
    let is_as_given = found.at.abs() < LEAST.max(SIGNIFICANT * deviation) || found.loss > GAIN * given.loss;
    if deviation > most_deviation {
        RatioOutcome::Unconstrained
    } else if is_as_given {
        RatioOutcome::AsGiven
    } else if outline_px > WORSE_OUTLINE * given.outline_px {
        RatioOutcome::OutlineDisagrees
    } else {
        RatioOutcome::Corrected
    }
}

impl Unknown {
    /// Largest standard deviation of a constrained value.
    fn most_deviation(self) -> f64 {
        match self {
            Self::FocalLength | Self::WorldScale => MOST_DEVIATION,
            Self::Lens(_) => MOST_LENS_DEVIATION,
        }
    }
}

/// Change of the logarithm at which the loss has risen by the model's error: noise alone would give
/// a tenth of it.
fn deviation(found: &Parabola) -> f64 {
    ((1.0 / GAIN - 1.0) * found.loss / found.bend).sqrt()
}
