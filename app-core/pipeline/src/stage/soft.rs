//! How soft a picture is taken to be: as it was measured, where that is seen, and the same as before where it is nearly so.

use app_scene::sharpness::{Sharpness, Spread};

/// A smaller standard deviation is not seen beside the shape of a pixel, and compression by JPEG alone measures as .36: nothing is softened then.
const LEAST_PX: f64 = 0.5;
/// A larger one is taken as this: what is farther from the toy is not in its boxes.
const MOST_PX: f64 = 4.0;
/// Difference of two standard deviations that is not seen, and may be noise of what measures them.
const ALIKE_PX: f64 = 0.15;

/// What of a measured sharpness is taken into account, where `known` is what the picture before had.
pub(super) fn taken(measured: Sharpness, known: Sharpness) -> Sharpness {
    let measured = Sharpness {
        plate_spread: seen(measured.plate_spread),
        outline_spread: seen(measured.outline_spread),
    };
    let is_alike = are_alike(measured.plate_spread, known.plate_spread)
        && are_alike(measured.outline_spread, known.outline_spread);
    if is_alike { known } else { measured }
}

/// Whether there is anything to be made as soft as the picture.
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

/// Whether two differ by no more than is not seen, in any direction. What has begun to be seen is not like what is not.
fn are_alike(a: Spread, b: Spread) -> bool {
    if a == b || a == Spread::NONE || b == Spread::NONE {
        return a == b;
    }
    let apart = a.and(b.times(-1.0)).variances_px2();
    let largest_px2 = apart[0].abs().max(apart[1].abs());
    largest_px2 <= 2.0 * ALIKE_PX * a.widest_px().max(b.widest_px())
}
