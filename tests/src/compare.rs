//! Compares a picture or a map with the expected one, texel by texel, all four channels.
//!
//! Pictures differ in 8-bit codes, maps in their own unit.

use app_core::scene::Image;
use app_pipeline::readback::FloatMap;
use thiserror::Error;

/// An array of texels with four channels, rows from the top.
pub trait Texels {
    /// Width and height.
    fn size(&self) -> [u32; 2];
    /// Number of texels that it really holds.
    fn n_texels(&self) -> usize;
    /// The texel `index`, below [`Texels::n_texels`].
    fn texel(&self, index: usize) -> [f64; 4];
}

impl Texels for Image {
    fn size(&self) -> [u32; 2] {
        [self.width_px, self.height_px]
    }

    fn n_texels(&self) -> usize {
        self.rgba8.len() / 4
    }

    fn texel(&self, index: usize) -> [f64; 4] {
        std::array::from_fn(|channel| f64::from(self.rgba8[4 * index + channel]))
    }
}

impl Texels for FloatMap {
    fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    fn n_texels(&self) -> usize {
        self.texels.len()
    }

    fn texel(&self, index: usize) -> [f64; 4] {
        self.texels[index].map(f64::from)
    }
}

/// The two sides of a comparison, by name.
#[derive(Debug)]
pub struct Pair<'a, T> {
    /// The expected side.
    pub expected: &'a T,
    /// The actual side; not the same object.
    pub actual: &'a T,
}

/// A condition on a [`Difference`]. A NaN anywhere fails every condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Check {
    /// No channel of any texel differs by more.
    MaxAbs(f64),
    /// Few texels have a channel that differs by more than `tolerance`.
    Outliers {
        /// Difference from which a texel is an outlier.
        tolerance: f64,
        /// Largest share of outliers among all texels, 0 to 1.
        max_share: f64,
    },
}

/// The reason why two sides count as different.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CompareError {
    /// No condition is given.
    #[error("the list of checks is empty")]
    NoChecks,
    /// A comparison that could never fail.
    #[error("expected and actual are one and the same object")]
    SameOrigin,
    /// The sizes differ.
    #[error("{expected:?} texels are expected, {actual:?} were made")]
    SizeDiffers {
        /// Width and height on the expected side.
        expected: [u32; 2],
        /// Width and height on the actual side.
        actual: [u32; 2],
    },
    /// A side's length contradicts its size, or is zero.
    #[error("{side} has {n_texels} texels instead of width times height, or none")]
    WrongLength {
        /// Name of the side.
        side: &'static str,
        /// Texels that it holds.
        n_texels: usize,
    },
    /// Some texels are NaN.
    #[error("{n_nan} texels hold a NaN")]
    NaN {
        /// Number of such texels, on either side.
        n_nan: usize,
    },
    /// A condition is not met.
    #[error(
        "{check:?} is not met: the largest difference is {max_abs}, the share of outliers {outlier_share}"
    )]
    NotMet {
        /// The condition.
        check: Check,
        /// Largest difference of a channel.
        max_abs: f64,
        /// Share of texels above the condition's tolerance.
        outlier_share: f64,
    },
}

/// The difference of two sides of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Width and height of both sides.
    pub size: [u32; 2],
    /// Largest difference of a channel, without NaN texels.
    pub max_abs: f64,
    /// Number of texels with a NaN on either side.
    pub n_nan: usize,
    /// Largest difference over the channels of each texel; NaN if either side has one.
    pub per_texel: Vec<f64>,
}

impl<T: Texels> Pair<'_, T> {
    /// The difference of the two sides.
    ///
    /// # Errors
    /// When they cannot be compared texel by texel.
    pub fn difference(&self) -> Result<Difference, CompareError> {
        if std::ptr::eq(self.expected, self.actual) {
            return Err(CompareError::SameOrigin);
        }
        let (expected, actual) = (self.expected.size(), self.actual.size());
        if expected != actual {
            return Err(CompareError::SizeDiffers { expected, actual });
        }
        check_length("expected", self.expected)?;
        check_length("actual", self.actual)?;
        let texel = |i| texel_difference(self.expected.texel(i), self.actual.texel(i));
        let per_texel: Vec<f64> = (0..self.expected.n_texels()).map(texel).collect();
        Ok(Difference {
            size: expected,
            // `max` skips NaN.
            max_abs: per_texel.iter().copied().fold(0.0, f64::max),
            n_nan: per_texel.iter().filter(|d| d.is_nan()).count(),
            per_texel,
        })
    }

    /// The difference, if it meets all `checks`.
    ///
    /// # Errors
    /// When it does not, when there are no checks, or when the sides cannot be compared.
    pub fn check(&self, checks: &[Check]) -> Result<Difference, CompareError> {
        let difference = self.difference()?;
        difference.check(checks)?;
        Ok(difference)
    }
}

impl Difference {
    /// Share of texels with a channel that differs by more than `tolerance`, or with a NaN; 0 to 1.
    #[must_use]
    pub fn share_above(&self, tolerance: f64) -> f64 {
        let is_within = |difference: &&f64| **difference <= tolerance;
        let n_within = self.per_texel.iter().filter(is_within).count();
        1.0 - n_within as f64 / self.per_texel.len() as f64
    }

    /// Whether all `checks` are met.
    ///
    /// # Errors
    /// When one is not, there is none, or there is a NaN.
    pub fn check(&self, checks: &[Check]) -> Result<(), CompareError> {
        if checks.is_empty() {
            return Err(CompareError::NoChecks);
        }
        if self.n_nan > 0 {
            return Err(CompareError::NaN { n_nan: self.n_nan });
        }
        match checks.iter().find(|check| !self.meets(check)) {
            None => Ok(()),
            Some(&check) => Err(CompareError::NotMet {
                check,
                max_abs: self.max_abs,
                outlier_share: self.share_above(check.tolerance()),
            }),
        }
    }

    fn meets(&self, check: &Check) -> bool {
        match *check {
            Check::MaxAbs(bound) => self.max_abs <= bound,
            Check::Outliers { tolerance, max_share } => self.share_above(tolerance) <= max_share,
        }
    }

    /// The differences as a picture: black for none, red at `full` and above, white for NaN.
    #[must_use]
    pub fn picture(&self, full: f64) -> Image {
        let rgba8 = self.per_texel.iter().flat_map(|&difference| {
            if difference.is_nan() {
                return [255; 4];
            }
            if difference == 0.0 {
                return [0, 0, 0, 255];
            }
            // Even the smallest difference must be visible.
            let share = (difference / full).clamp(0.0, 1.0);
            #[expect(clippy::cast_possible_truncation, reason = "64 to 255")]
            let red = (64.0 + 191.0 * share) as u8;
            [red, 32, 32, 255]
        });
        Image {
            width_px: self.size[0],
            height_px: self.size[1],
            rgba8: rgba8.collect(),
        }
    }
}

impl Check {
    fn tolerance(&self) -> f64 {
        match *self {
            Self::MaxAbs(bound) => bound,
            Self::Outliers { tolerance, .. } => tolerance,
        }
    }
}

fn check_length<T: Texels>(side: &'static str, texels: &T) -> Result<(), CompareError> {
    let (n_texels, [width, height]) = (texels.n_texels(), texels.size());
    let is_whole = n_texels as u64 == u64::from(width) * u64::from(height);
    if is_whole && n_texels > 0 {
        Ok(())
    } else {
        Err(CompareError::WrongLength { side, n_texels })
    }
}

fn texel_difference(expected: [f64; 4], actual: [f64; 4]) -> f64 {
    let channels = expected.into_iter().zip(actual);
    channels.fold(0.0, |largest: f64, (expected, actual)| {
        if expected.is_nan() || actual.is_nan() || largest.is_nan() {
            f64::NAN
        } else if expected == actual {
            // Two infinities are equal, although their difference is NaN.
            largest
        } else {
            largest.max((expected - actual).abs())
        }
    })
}
