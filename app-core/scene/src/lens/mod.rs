//! Lens distortion: photographs are undistorted to a pinhole's, and results are distorted back.
//!
//! All passes assume a pinhole camera. So a photograph is resampled to the picture of a pinhole
//! with the same intrinsics, and of the finished picture only the **changes** are resampled back
//! onto the photograph: pixels that toy and shadow do not touch keep the camera's codes.

mod resample;

use std::ops::RangeInclusive;

use glam::DVec2;
use serde::Serialize;

use crate::scene::{FieldError, Image, Intrinsics};

pub use resample::resampled;

/// Coefficients of any real lens, with a wide margin.
pub const COEFFICIENT: RangeInclusive<f64> = -10.0..=10.0;
/// The radial map must increase up to this multiple of the farthest corner's distance from the
/// principal point.
const BEYOND: f64 = 1.5;
/// Steps of Newton's method, and the relative size of the last step.
const N_STEPS: usize = 30;
const LAST_STEP: f64 = 1e-13;

/// Radial distortion (Brown 1966), two terms.
///
/// The pinhole's point `(x, y) = ((u - cx) / fx, (v - cy) / fy)`, with `r2 = x x + y y`, is at
/// `(1 + k1 r2 + k2 r2 r2) (x, y)` in the photograph. Negative coefficients are a barrel, positive
/// ones a pincushion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distortion {
    /// Coefficient of `r2`.
    pub k1: f64,
    /// Coefficient of `r2 r2`.
    pub k2: f64,
}

impl Distortion {
    /// No distortion: a pinhole.
    pub const NONE: Self = Self { k1: 0.0, k2: 0.0 };

    /// Refuses a lens that maps two places of a picture's field of view to one.
    pub(crate) fn check(&self, intrinsics: &Intrinsics, size_px: [u32; 2]) -> Result<(), FieldError> {
        let Intrinsics {
            fx_px,
            fy_px,
            cx_px,
            cy_px,
        } = *intrinsics;
        let [right, bottom] = size_px.map(f64::from);
        let farthest_x = cx_px.abs().max((right - cx_px).abs()) / fx_px;
        let farthest_y = cy_px.abs().max((bottom - cy_px).abs()) / fy_px;
        let most2 = (BEYOND * BEYOND) * farthest_x.mul_add(farthest_x, farthest_y * farthest_y);
        // The minimum of a parabola in r2 is at an end or at its vertex.
        let slope = |r2: f64| 1.0 + r2 * (3.0 * self.k1 + 5.0 * self.k2 * r2);
        let vertex2 = if self.k2 > 0.0 {
            (-0.3 * self.k1 / self.k2).clamp(0.0, most2)
        } else {
            0.0
        };
        let reaches_corners = BEYOND * self.factor(most2) >= 1.0;
        if reaches_corners && slope(vertex2) > 0.0 && slope(most2) > 0.0 {
            Ok(())
        } else {
            Err(FieldError::Folds)
        }
    }

    fn factor(&self, r2: f64) -> f64 {
        1.0 + r2 * (self.k1 + self.k2 * r2)
    }

    /// The photograph's image of a pinhole's point, both in pixels.
    fn distorted(&self, intrinsics: &Intrinsics, at_px: DVec2) -> DVec2 {
        let [centre, focal] = centre_and_focal(intrinsics);
        let slope = (at_px - centre) / focal;
        centre + focal * slope * self.factor(slope.length_squared())
    }

    /// The pinhole's image of a photograph's point, both in pixels; for a checked lens.
    fn undistorted(&self, intrinsics: &Intrinsics, at_px: DVec2) -> DVec2 {
        let [centre, focal] = centre_and_focal(intrinsics);
        let slope = (at_px - centre) / focal;
        let distorted_r = slope.length();
        if distorted_r == 0.0 {
            return at_px;
        }
        let mut r = distorted_r;
        for _ in 0..N_STEPS {
            let r2 = r * r;
            let derivative = 1.0 + r2 * (3.0 * self.k1 + 5.0 * self.k2 * r2);
            let step = (r * self.factor(r2) - distorted_r) / derivative;
            r -= step;
            if step.abs() <= LAST_STEP * distorted_r {
                break;
            }
        }
        centre + focal * slope * (r / distorted_r)
    }
}

fn centre_and_focal(intrinsics: &Intrinsics) -> [DVec2; 2] {
    [
        DVec2::new(intrinsics.cx_px, intrinsics.cy_px),
        DVec2::new(intrinsics.fx_px, intrinsics.fy_px),
    ]
}

/// A lens with the intrinsics for which it was checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    distortion: Distortion,
    intrinsics: Intrinsics,
}

impl Lens {
    /// Refuses a lens that folds pictures of the given size.
    pub fn new(
        distortion: Distortion,
        intrinsics: &Intrinsics,
        size_px: [u32; 2],
    ) -> Result<Self, FieldError> {
        distortion.check(intrinsics, size_px)?;
        Ok(Self {
            distortion,
            intrinsics: *intrinsics,
        })
    }

    /// The picture of a pinhole with the photograph's size and intrinsics. The photograph's border
    /// pixels are repeated outside.
    pub fn to_pinhole(self, photograph: &Image) -> Image {
        resampled(photograph, |at_px| {
            self.distortion.distorted(&self.intrinsics, at_px)
        })
    }

    /// Distorts a map of the pinhole's picture: each pixel is one of the map's, or all zero outside
    /// of the pinhole's picture. All four channels are copied unchanged.
    pub fn of_map(self, map: &Image) -> Image {
        resample::nearest(map, |at_px| self.distortion.undistorted(&self.intrinsics, at_px))
    }

    /// The photograph with the changes of its [`Self::to_pinhole`]: all three of one size.
    /// Unchanged pixels, and pixels outside of the pinhole's picture, keep their codes.
    pub fn with_changes(self, photograph: &Image, [before, after]: [&Image; 2]) -> Image {
        resample::with_changes(photograph, [before, after], |at_px| {
            self.distortion.undistorted(&self.intrinsics, at_px)
        })
    }
}
