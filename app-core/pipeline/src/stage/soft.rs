//! The softness that is used for a picture: the measured one if it is visible, and the previous one
//! if it is nearly equal.

use app_scene::sharpness::{Sharpness, Spread};

/// A smaller standard deviation is not visible beside the extent of a pixel, and JPEG compression
/// alone measures as .36: nothing is softened below it.
const LEAST_PX: f64 = 0.5;
/// A larger standard deviation is limited to this one: the toy's boxes contain nothing farther
/// away.
const MOST_PX: f64 = 4.0;
/// Difference of two standard deviations that is invisible, and may be noise of their measurement.
const ALIKE_PX: f64 = 0.15;

/// The sharpness that is used for a measured one; `known` is that of the previous picture.
pub(super) fn taken(measured: Sharpness, known: Sharpness) -> Sharpness {
    let measured = Sharpness {
        plate_spread: seen(measured.plate_spread),
        outline_spread: seen(measured.outline_spread),
    };
    let is_alike = are_alike(measured.plate_spread, known.plate_spread)
        && are_alike(measured.outline_spread, known.outline_spread);
    if is_alike { known } else { measured }
}

/// Whether anything must be blurred like the picture.
pub(super) fn is_soft(sharpness: Sharpness) -> bool {
    sharpness != Sharpness::SHARP
}

fn seen(spread: Spread) -> Spread {
    let widest_px = spread.widest_px();
    if widest_px < LEAST_PX {
        return Spread::NONE;
    }
    spread.times((MOST_PX / widest_px).min(1.0).powi(2))
}

/// Whether two blurs differ invisibly in every direction. A blur that is just visible is not equal
/// to an invisible one.
fn are_alike(a: Spread, b: Spread) -> bool {
    if a == b || a == Spread::NONE || b == Spread::NONE {
        return a == b;
    }
    let apart = a.and(b.times(-1.0)).variances_px2();
    let largest_px2 = apart[0].abs().max(apart[1].abs());
    largest_px2 <= 2.0 * ALIKE_PX * a.widest_px().max(b.widest_px())
}
