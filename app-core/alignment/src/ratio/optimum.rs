//! The value of an unknown with the least loss: in a small picture, and around what that tells in a larger one.

use super::minimum::{Parabola, Span, least};
use super::trials::{Trial, Trials, Unseen};
use super::unknown::Unknown;
use crate::report::RatioOutcome;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, Scene};

/// Logarithms of ratios that are tried first, and what a lens adds at the farthest corner: how far apart. The largest is asked for.
const COARSE: Span = Span {
    start: 0.0,
    step: 0.01,
    most: 0.0,
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
/// The same for what a lens adds at the farthest corner: where toy and shadow are, it adds a fifth of that.
const MOST_LENS_DEVIATION: f64 = 0.02;
/// A smaller one does not show: a sixth of a millimetre along the view at the distance of an arm.
const LEAST: f64 = 5e-4;
/// Deviations that it must differ by.
const TOLD: f64 = 2.0;
/// What the outline's distance may rise to, over that with what was given.
const WORSE_OUTLINE: f64 = 1.015;

/// The number with the least loss.
pub(super) struct Found {
    pub(super) at: f64,
    pub(super) outcome: RatioOutcome,
    pub(super) deviation: f64,
    /// As given, and as found.
    pub(super) errors: [f64; 2],
}

/// Looks for the least loss up to a largest number, in the small picture, and around that in the larger one; none where it is in neither.
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
    let is_as_given = found.at.abs() < LEAST.max(TOLD * deviation) || found.loss > GAIN * given.loss;
    if deviation > most_deviation {
        RatioOutcome::NotTold
    } else if is_as_given {
        RatioOutcome::AsGiven
    } else if outline_px > WORSE_OUTLINE * given.outline_px {
        RatioOutcome::OutlineDisagrees
    } else {
        RatioOutcome::Corrected
    }
}

impl Unknown {
    /// A deviation that is larger tells nothing.
    fn most_deviation(self) -> f64 {
        match self {
            Self::FocalLength | Self::WorldScale => MOST_DEVIATION,
            Self::Lens(_) => MOST_LENS_DEVIATION,
        }
    }
}

/// How far the logarithm may be off before the loss has risen by what errors of the model are taken for: noise alone would promise ten
/// times as much.
fn deviation(found: &Parabola) -> f64 {
    ((1.0 / GAIN - 1.0) * found.loss / found.bend).sqrt()
}
