//! The softness of a picture: by its lens, defocus, or motion during the exposure.

use glam::DVec2;

use crate::scene::{FieldError, InputError};

/// Largest variance of a blur, along any direction, in square pixels.
const MOST_PX2: f64 = 1e4;
/// Variance of a line and of the blur beside it, over the latter.
const LINE_TO_ROUND: f64 = 4.0;
/// Rounding tolerance of a covariance, over its trace.
const ROUNDING: f64 = 1e-9;

/// The point spread function of a picture, by its covariance in square pixels, x to the right and y
/// down: a uniform line if it is much longer than wide, else a Gaussian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Variance along the rows.
    pub xx_px2: f64,
    /// Covariance.
    pub xy_px2: f64,
    /// Variance along the columns.
    pub yy_px2: f64,
}

impl Spread {
    /// No blur.
    pub const NONE: Self = Self {
        xx_px2: 0.0,
        xy_px2: 0.0,
        yy_px2: 0.0,
    };

    /// An isotropic blur, as of defocus, by its standard deviation in pixels.
    #[must_use]
    pub fn round(deviation_px: f64) -> Self {
        let variance = deviation_px * deviation_px;
        Self {
            xx_px2: variance,
            xy_px2: 0.0,
            yy_px2: variance,
        }
    }

    /// The blur of a uniform motion by `by_px` during the exposure.
    #[must_use]
    pub fn of_motion(by_px: DVec2) -> Self {
        // An interval of length 1 has a variance of a twelfth.
        Self {
            xx_px2: by_px.x * by_px.x / 12.0,
            xy_px2: by_px.x * by_px.y / 12.0,
            yy_px2: by_px.y * by_px.y / 12.0,
        }
    }

    /// One blur after the other.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            xx_px2: self.xx_px2 + other.xx_px2,
            xy_px2: self.xy_px2 + other.xy_px2,
            yy_px2: self.yy_px2 + other.yy_px2,
        }
    }

    /// The same blur with all variances times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            xx_px2: factor * self.xx_px2,
            xy_px2: factor * self.xy_px2,
            yy_px2: factor * self.yy_px2,
        }
    }

    /// Its variances along its principal axes, the larger first.
    #[must_use]
    pub fn variances_px2(self) -> [f64; 2] {
        let middle = 0.5 * (self.xx_px2 + self.yy_px2);
        let apart = (0.5 * (self.xx_px2 - self.yy_px2)).hypot(self.xy_px2);
        [middle + apart, middle - apart]
    }

    /// The largest standard deviation over all directions, in pixels.
    #[must_use]
    pub fn widest_px(self) -> f64 {
        self.variances_px2()[0].max(0.0).sqrt()
    }

    /// The standard deviation of an isotropic blur with the same variance, in pixels.
    #[must_use]
    pub fn mean_px(self) -> f64 {
        (0.5 * (self.xx_px2 + self.yy_px2)).max(0.0).sqrt()
    }

    /// Its two principal axes, the wider first, each as long as the standard deviation along it;
    /// the picture's axes for an isotropic blur.
    #[must_use]
    pub fn axes_px(self) -> [DVec2; 2] {
        let [wide, narrow] = self.variances_px2().map(|variance| variance.max(0.0).sqrt());
        let apart = self.xx_px2 - self.yy_px2;
        // Half the angle of the vector of both differences; 0 for a zero vector.
        let along = DVec2::from_angle(0.5 * (2.0 * self.xy_px2).atan2(apart));
        [wide * along, narrow * along.perp()]
    }

    /// Whether it is a line's: that of a uniform motion, with at least three times the variance of
    /// anything else.
    #[must_use]
    pub fn is_line(self) -> bool {
        let [wide, narrow] = self.variances_px2();
        wide > 0.0 && wide >= LINE_TO_ROUND * narrow
    }

    fn check(self, field: &str) -> Result<(), InputError> {
        let values = [
            ("xx_px2", self.xx_px2),
            ("xy_px2", self.xy_px2),
            ("yy_px2", self.yy_px2),
        ];
        let range = |(name, value): (&str, f64), min: f64| {
            // Written so that NaN is refused.
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
        // A covariance is positive semidefinite.
        let [wide, narrow] = self.variances_px2();
        range(("narrowest", narrow + ROUNDING * wide), 0.0)
    }
}

/// Measured softness of a picture, relative to the images that are composed into it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sharpness {
    /// The blur that makes the plates as soft as the picture; `None` if they are at least as soft.
    pub plate_spread: Spread,
    /// The blur that makes an antialiased edge as soft as edges in the picture.
    pub outline_spread: Spread,
}

impl Sharpness {
    /// A perfectly sharp picture, with equal plates.
    pub const SHARP: Self = Self {
        plate_spread: Spread::NONE,
        outline_spread: Spread::NONE,
    };

    pub(crate) fn check(&self, field: &str) -> Result<(), InputError> {
        self.plate_spread.check(&format!("{field}.plate_spread"))?;
        self.outline_spread.check(&format!("{field}.outline_spread"))
    }
}
