//! A lens that bends straight lines: photographs through it are made those of a pinhole, and what was made of them is put back.
//!
//! All passes are of a pinhole camera. So a photograph is resampled to what a pinhole of the same intrinsics would have
//! seen, and of the finished picture only what **changed** is resampled back onto the photograph: what the toy and its shadow do not
//! touch stays as the camera gave it, code by code.

mod resample;

use std::ops::RangeInclusive;

use glam::DVec2;
use serde::Serialize;

use crate::scene::{FieldError, Image, Intrinsics};

pub use resample::resampled;

/// Coefficients of any real lens, and far more.
pub const COEFFICIENT: RangeInclusive<f64> = -10.0..=10.0;
/// A lens must go outwards as far beyond the farthest corner, in parts of its distance from the principal point.
const BEYOND: f64 = 1.5;
/// Steps of Newton's method, and the last of them over the radius.
const N_STEPS: usize = 30;
const LAST_STEP: f64 = 1e-13;

/// Radial distortion (Brown 1966), two terms.
///
/// At the place `(x, y) = ((u - cx) / fx, (v - cy) / fy)` of a pinhole's picture, with `r2 = x x + y y`, is seen what the photograph
/// has at `(1 + k1 r2 + k2 r2 r2) (x, y)`. Negative is a barrel, positive a cushion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distortion {
    /// Of `r2`.
    pub k1: f64,
    /// Of `r2 r2`.
    pub k2: f64,
}

impl Distortion {
    /// That of a pinhole.
    pub const NONE: Self = Self { k1: 0.0, k2: 0.0 };

    /// Refuses a lens that shows two places of a picture's field of view at one.
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
        // A parabola in r2 is least at an end or at its vertex.
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

    /// Where the photograph has what a pinhole sees at a place, both in pixels.
    fn distorted(&self, intrinsics: &Intrinsics, at_px: DVec2) -> DVec2 {
        let [centre, focal] = centre_and_focal(intrinsics);
        let slope = (at_px - centre) / focal;
        centre + focal * slope * self.factor(slope.length_squared())
    }

    /// Where a pinhole sees what the photograph has at a place, both in pixels; of a lens that was checked.
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

/// A lens with the intrinsics of a camera, for which it was checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    distortion: Distortion,
    intrinsics: Intrinsics,
}

impl Lens {
    /// Refuses one that folds pictures of a size.
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

    /// What a pinhole would have seen, of the photograph's size and intrinsics. Beside the photograph its border goes on.
    pub fn to_pinhole(self, photograph: &Image) -> Image {
        resampled(photograph, |at_px| {
            self.distortion.distorted(&self.intrinsics, at_px)
        })
    }

    /// A map of what a pinhole sees, as the lens shows it: each pixel is one of the map's, and none, all zero, where the pinhole does not
    /// reach. All four channels are taken as they are.
    pub fn of_map(self, map: &Image) -> Image {
        resample::nearest(map, |at_px| self.distortion.undistorted(&self.intrinsics, at_px))
    }

    /// The photograph with what was changed in its [`Self::to_pinhole`]: all three of one size. Where nothing changed it is as it was,
    /// code by code; so it is where the pinhole does not reach.
    pub fn with_changes(self, photograph: &Image, [before, after]: [&Image; 2]) -> Image {
        resample::with_changes(photograph, [before, after], |at_px| {
            self.distortion.undistorted(&self.intrinsics, at_px)
        })
    }
}
