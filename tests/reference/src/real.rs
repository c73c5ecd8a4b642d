//! Real numbers of either precision: rays have 64 bits, or 32 to measure rounding errors.
//!
//! Inputs and outputs stay in 64 bits, which represent all 32-bit numbers: only the arithmetic in
//! between has the requested precision.

use std::array;
use std::cmp::Ordering;
use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub};

use glam::DVec3;

/// A floating-point number.
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + Sum
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The nearest one to `value`.
    #[must_use]
    fn from_f64(value: f64) -> Self;
    /// The same number.
    #[must_use]
    fn to_f64(self) -> f64;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The larger one.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The smaller one.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// A total order, including NaN.
    fn total_cmp(&self, other: &Self) -> Ordering;
}

macro_rules! impl_real {
    ($float:ty) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            #[allow(
                clippy::cast_possible_truncation,
                reason = "rounding is what is asked for"
            )]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            fn sqrt(self) -> Self {
                self.sqrt()
            }

            fn max(self, other: Self) -> Self {
                self.max(other)
            }

            fn min(self, other: Self) -> Self {
                self.min(other)
            }

            fn total_cmp(&self, other: &Self) -> Ordering {
                self.total_cmp(other)
            }
        }
    };
}

impl_real!(f32);
impl_real!(f64);

/// A vector or point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<R>(pub [R; 3]);

impl<R: Real> Vector<R> {
    /// The same component three times.
    #[must_use]
    pub fn splat(value: R) -> Self {
        Self([value; 3])
    }

    /// Applies `of` to each component and that of `other`.
    fn zip(self, other: Self, of: impl Fn(R, R) -> R) -> Self {
        Self(array::from_fn(|i| of(self[i], other[i])))
    }

    /// Dot product.
    #[must_use]
    pub fn dot(self, other: Self) -> R {
        self.zip(other, |a, b| a * b).0.into_iter().sum()
    }

    /// Length.
    #[must_use]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    /// The smaller of each two components; that of `other` if one is NaN.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// The larger of each two components; that of `other` if one is NaN.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// The smallest component; a NaN is skipped in favour of later ones.
    #[must_use]
    pub fn min_element(self) -> R {
        let backwards = self.0.into_iter().rev();
        backwards.fold(self[2], |least, one| if one < least { one } else { least })
    }

    /// The largest component; a NaN is skipped in favour of later ones.
    #[must_use]
    pub fn max_element(self) -> R {
        let backwards = self.0.into_iter().rev();
        backwards.fold(self[2], |most, one| if one > most { one } else { most })
    }

    /// Cross product.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        let ([x, y, z], [u, v, w]) = (self.0, other.0);
        Self([y * w - v * z, z * u - w * x, x * v - u * y])
    }

    /// Two unit vectors at right angles to each other and to this one, which is of length 1.
    ///
    /// Source: Duff et al. 2017.
    #[must_use]
    pub fn orthonormal_pair(self) -> (Self, Self) {
        let [x, y, z] = self.0;
        let sign = R::from_f64(z.to_f64().signum());
        let a = -R::ONE / (sign + z);
        let b = x * y * a;
        (
            Self([R::ONE + sign * x * x * a, sign * b, -sign * x]),
            Self([b, sign + y * y * a, -y]),
        )
    }
}

impl<R> Index<usize> for Vector<R> {
    type Output = R;

    fn index(&self, i: usize) -> &R {
        &self.0[i]
    }
}

impl<R: Real> Add for Vector<R> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<R: Real> Sub for Vector<R> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

/// Component by component.
impl<R: Real> Div for Vector<R> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl<R: Real> Mul<R> for Vector<R> {
    type Output = Self;

    fn mul(self, factor: R) -> Self {
        Self(self.0.map(|value| value * factor))
    }
}

impl<R: Real> Div<R> for Vector<R> {
    type Output = Self;

    fn div(self, divisor: R) -> Self {
        Self(self.0.map(|value| value / divisor))
    }
}

impl<R: Real> From<DVec3> for Vector<R> {
    fn from(value: DVec3) -> Self {
        Self(value.to_array().map(R::from_f64))
    }
}

impl<R: Real> From<Vector<R>> for DVec3 {
    fn from(value: Vector<R>) -> Self {
        value.0.map(R::to_f64).into()
    }
}
