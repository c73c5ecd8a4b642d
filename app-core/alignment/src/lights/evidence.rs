//! Decides whether an estimate is a lamp, or an error of the light model.

use glam::DVec3;

use super::cast::Caster;
use super::lamp::Lamp;
use super::shading::Shading;
use super::shadows::Shadows;
use crate::receivers::up;

/// Bounds on the lamps' shares of the light at the toy's foot.
struct Bounds {
    /// Lower bound for each.
    least: f64,
    /// Upper bound for the sum: above 1 by the error of a fit.
    most: f64,
}

/// Measured: false lamps gave up to .08, but broad; a bulb of .06 was found with .057.
const WITH_PLATE: Bounds = Bounds {
    least: 0.04,
    most: 1.05,
};
/// The colour under a shadow is less certain then.
///
/// Measured: false lamps gave .04; a lamp of a real room, of .6 in larger pictures, 1.02 to 1.31 in
/// small ones.
const WITHOUT_PLATE: Bounds = Bounds {
    least: 0.1,
    most: 1.5,
};
/// Smallest ratio of a lamp's radiance to the mean of its surroundings.
///
/// Measured: false lamps 0.2 to 1.1 times, from toys that reflect light and uneven skies; a lamp 40
/// degrees wide 7 times.
const OUTSHINES: f64 = 3.0;
/// Lower bound of the surroundings, as a share of the light.
const LEAST_AMBIENT: f64 = 0.1;
/// Smallest distance of a lamp from the toy's centre, over the toy's radius.
const NEAREST: f64 = 2.0;
/// Sine of a lamp's lowest elevation, below which its share is small.
const LOWEST: f64 = 0.1;

/// The fraction of the remaining loss that a lamp must explain.
///
/// Measured: uneven skies fell by .6, but to lamps that do not outshine them; bulbs of a share of
/// .06 by .3, of more by .5 to .99, false lamps by .05 to .24.
const GAIN: f64 = 0.2;

/// Whether one more lamp explains enough.
pub(super) fn is_gain(loss_before: f64, loss: f64) -> bool {
    loss < (1.0 - GAIN) * loss_before
}

/// Whether a lamp outshines its surroundings; `up` is the normal of the receiver nearest to the
/// toy.
pub(super) fn outshines(lamps: &[Lamp], index: usize, shading: &Shading, up: DVec3) -> bool {
    let shares: f64 = (0..lamps.len()).map(|lamp| shading.share(0, lamp)).sum();
    let ambient = (1.0 - shares).max(LEAST_AMBIENT);
    let lamp = &lamps[index];
    let cosine = lamp.direction.dot(up).max(LOWEST);
    // Radiances relative to a uniform hemisphere with all of the light.
    shading.share(0, index) > OUTSHINES * ambient * lamp.spread.powi(2) * cosine
}

/// The last of the lamps that is implausible.
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
            && lamp.inverse_distance * radius_m * NEAREST < 1.0
            && !lamps[..index].iter().any(overlaps)
            && !(is_last && shares > bounds.most)
    };
    (0..lamps.len()).rev().find(|index| !is_lamp(*index))
}
