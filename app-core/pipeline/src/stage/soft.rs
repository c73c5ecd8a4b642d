//! The softness that is used for a picture: the measured one if it is visible, and the previous one
//! if it is nearly equal.

use glam::DMat2;

use crate::passes::globals::PIXEL_PX2;
use app_scene::sharpness::{Sharpness, Spread};

/// A smaller standard deviation is not visible beside the extent of a pixel, and JPEG compression
/// alone measures as .36: nothing is softened below it.
const LEAST_PX: f64 = 0.5;
/// A larger standard deviation is limited to this one. The toy's boxes contain all but the outermost
/// positions of such a blur.
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

/// Whether two blurs differ invisibly in every direction, together with the extent of a pixel. A blur
/// that is just visible is not equal to an invisible one.
fn are_alike(a: Spread, b: Spread) -> bool {
    if a == b || a == Spread::NONE || b == Spread::NONE {
        return a == b;
    }
    let [a, b] = [a, b].map(|spread| root_px(spread.and(Spread::round(PIXEL_PX2.sqrt()))));
    let apart = a - b;
    // The norm of the roots' difference: in no direction are the standard deviations farther apart.
    let middle = 0.5 * (apart.x_axis.x + apart.y_axis.y);
    let from_middle = (0.5 * (apart.x_axis.x - apart.y_axis.y)).hypot(apart.x_axis.y);
    middle.abs() + from_middle <= ALIKE_PX
}

/// The symmetric root of a blur's covariance, in pixels.
fn root_px(spread: Spread) -> DMat2 {
    let [wide, narrow] = spread.axes_px().map(|axis| {
        let along = axis.normalize_or_zero();
        DMat2::from_cols(along.x * axis, along.y * axis)
    });
    wide + narrow
}
