//! How soft a picture is: by its lens, out of focus, or by a motion while it was taken.

use glam::DVec2;

use crate::scene::{FieldError, InputError};

/// Variance that no picture's spread exceeds, along any direction, in square pixels.
const MOST_PX2: f64 = 1e4;
/// Rounding by which a covariance may miss being one, over its trace.
const ROUNDING: f64 = 1e-9;

/// What a point of light becomes in a picture: a Gaussian, by its covariance in square pixels, x to the right and y down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Variance across the picture.
    pub xx_px2: f64,
    /// Covariance.
    pub xy_px2: f64,
    /// Variance down the picture.
    pub yy_px2: f64,
}

impl Spread {
    /// A point stays one.
    pub const NONE: Self = Self {
        xx_px2: 0.0,
        xy_px2: 0.0,
        yy_px2: 0.0,
    };

    /// The same in all directions, as a lens out of focus gives it, by its standard deviation in pixels.
    #[must_use]
    pub fn round(deviation_px: f64) -> Self {
        let variance = deviation_px * deviation_px;
        Self {
            xx_px2: variance,
            xy_px2: 0.0,
            yy_px2: variance,
        }
    }

    /// That of an even motion by so many pixels while the picture was taken.
    #[must_use]
    pub fn of_motion(by_px: DVec2) -> Self {
        // An interval of length 1 has a variance of a twelfth.
        Self {
            xx_px2: by_px.x * by_px.x / 12.0,
            xy_px2: by_px.x * by_px.y / 12.0,
            yy_px2: by_px.y * by_px.y / 12.0,
        }
    }

    /// One after the other.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            xx_px2: self.xx_px2 + other.xx_px2,
            xy_px2: self.xy_px2 + other.xy_px2,
            yy_px2: self.yy_px2 + other.yy_px2,
        }
    }

    /// The same shape with all variances times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            xx_px2: factor * self.xx_px2,
            xy_px2: factor * self.xy_px2,
            yy_px2: factor * self.yy_px2,
        }
    }

    /// Its variances along its axes, the larger first.
    #[must_use]
    pub fn variances_px2(self) -> [f64; 2] {
        let middle = 0.5 * (self.xx_px2 + self.yy_px2);
        let apart = (0.5 * (self.xx_px2 - self.yy_px2)).hypot(self.xy_px2);
        [middle + apart, middle - apart]
    }

    /// The standard deviation in the direction in which it is widest, in pixels.
    #[must_use]
    pub fn widest_px(self) -> f64 {
        self.variances_px2()[0].max(0.0).sqrt()
    }

    /// The standard deviation of a round spread of as much variance, in pixels.
    #[must_use]
    pub fn mean_px(self) -> f64 {
        (0.5 * (self.xx_px2 + self.yy_px2)).max(0.0).sqrt()
    }

    /// Its two axes, the wider first, each as long as the standard deviation along it; across and down where it is round.
    #[must_use]
    pub fn axes_px(self) -> [DVec2; 2] {
        let [wide, narrow] = self.variances_px2().map(|variance| variance.max(0.0).sqrt());
        let apart = self.xx_px2 - self.yy_px2;
        // Half the angle of the vector of both differences; that of none is 0.
        let along = DVec2::from_angle(0.5 * (2.0 * self.xy_px2).atan2(apart));
        [wide * along, narrow * along.perp()]
    }

    fn check(self, field: &str) -> Result<(), InputError> {
        let values = [
            ("xx_px2", self.xx_px2),
            ("xy_px2", self.xy_px2),
            ("yy_px2", self.yy_px2),
        ];
        let range = |(name, value): (&str, f64), min: f64| {
            // Written so that what is no number is refused.
            if (min..=MOST_PX2).contains(&value) {
                return Ok(());
            }
            Err(InputError {
                field: format!("{field}.{name}"),
                reason: FieldError::Range {
                    value,
                    min,
                    max: MOST_PX2,
                },
            })
        };
        range(values[0], 0.0)?;
        range(values[1], -MOST_PX2)?;
        range(values[2], 0.0)?;
        // A covariance has no negative variance in any direction.
        let [wide, narrow] = self.variances_px2();
        range(("narrowest", narrow + ROUNDING * wide), 0.0)
    }
}

/// How soft a picture is beside what is laid into it, as it was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sharpness {
    /// What makes the plates as soft as the picture; none where they are as soft, or softer.
    pub plate_spread: Spread,
    /// What makes an edge that is drawn by the area of pixels as soft as those in the picture.
    pub outline_spread: Spread,
}

impl Sharpness {
    /// As sharp as pixels are, with plates alike.
    pub const SHARP: Self = Self {
        plate_spread: Spread::NONE,
        outline_spread: Spread::NONE,
    };

    pub(crate) fn check(&self, field: &str) -> Result<(), InputError> {
        self.plate_spread.check(&format!("{field}.plate_spread"))?;
        self.outline_spread.check(&format!("{field}.outline_spread"))
    }
}
