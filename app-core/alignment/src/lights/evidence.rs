//! Whether what was found is a lamp, or what the model of light leaves unexplained.

use glam::DVec3;

use super::cast::Caster;
use super::lamp::Lamp;
use super::shading::Shading;
use super::shadows::Shadows;
use crate::receivers::up;

/// Bounds on what lamps give of the light at the toy's foot.
struct Bounds {
    /// Of each.
    least: f64,
    /// Of all: what a fit may be off comes on top of 1.
    most: f64,
}

/// Measured: what is none gave up to .08, but broad; a bulb of .06 was found with .057.
const WITH_PLATE: Bounds = Bounds {
    least: 0.04,
    most: 1.05,
};
/// The colour under a shadow is less certain then.
///
/// Measured: what is none gave .04; a lamp of a real room, of .6 in larger pictures, 1.02 to 1.31 in small ones.
const WITHOUT_PLATE: Bounds = Bounds {
    least: 0.1,
    most: 1.5,
};
/// A lamp is brighter than the mean of its surroundings, or it is one of them.
///
/// Measured: what is none 0.2 to 1.1 times, from toys that throw light back and uneven skies; a lamp 40 degrees wide 7 times.
const OUTSHINES: f64 = 3.0;
/// Surroundings are not taken for darker, as a part of the light.
const LEAST_AMBIENT: f64 = 0.1;
/// A lamp is farther from the toy's middle, over the toy's radius.
const NEAREST: f64 = 2.0;
/// No lamp is lower, as a sine; its share is of little light.
const LOWEST: f64 = 0.1;

/// The part of the loss that a lamp explains, of what those before it leave.
///
/// Measured: uneven skies fell by .6, but to what does not outshine them; bulbs of a share of .06 by .3, of more by .5 to .99, what is
/// none by .05 to .24.
const GAIN: f64 = 0.2;

/// Whether one more lamp explains enough.
pub(super) fn is_gain(loss_before: f64, loss: f64) -> bool {
    loss < (1.0 - GAIN) * loss_before
}

/// Whether a lamp shines out of its surroundings; `up` is the normal of the receiver nearest to the toy.
pub(super) fn outshines(lamps: &[Lamp], index: usize, shading: &Shading, up: DVec3) -> bool {
    let shares: f64 = (0..lamps.len()).map(|lamp| shading.share(0, lamp)).sum();
    let ambient = (1.0 - shares).max(LEAST_AMBIENT);
    let lamp = &lamps[index];
    let cosine = lamp.direction.dot(up).max(LOWEST);
    // Radiances over that of an even hemisphere with all of the light.
    shading.share(0, index) > OUTSHINES * ambient * lamp.spread.powi(2) * cosine
}

/// The last of the lamps that cannot be one.
pub(super) fn doubtful(lamps: &[Lamp], shading: &Shading, shadows: &Shadows) -> Option<usize> {
    let Caster { shape, receivers, .. } = shadows.caster;
    let (up, radius_m) = (up(receivers), shape.radius_m);
    let bounds = if shadows.has_plate {
        WITH_PLATE
    } else {
        WITHOUT_PLATE
    };
    let shares: f64 = (0..lamps.len()).map(|lamp| shading.share(0, lamp)).sum();
    let is_lamp = |index: usize| {
        let lamp = &lamps[index];
        let overlaps = |other: &Lamp| {
            lamp.direction.angle_between(other.direction) < lamp.spread.atan() + other.spread.atan()
        };
        let is_last = index + 1 == lamps.len();
        shading.share(0, index) >= bounds.least
            && outshines(lamps, index, shading, up)
            && lamp.nearness * radius_m * NEAREST < 1.0
            && !lamps[..index].iter().any(overlaps)
            && !(is_last && shares > bounds.most)
    };
    (0..lamps.len()).rev().find(|index| !is_lamp(*index))
}
