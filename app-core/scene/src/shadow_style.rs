//! Artistic control of the shown shadow: its strength and softness relative to the truth.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::scene::{InputError, check};

/// Range of the strength: with 4, a shadow that leaves half of the light leaves a sixteenth.
pub const STRENGTH: RangeInclusive<f64> = 0.0..=4.0;
/// Range of the softness: a wider light would often lie partly below the table.
pub const SOFTNESS: RangeInclusive<f64> = 0.0..=4.0;

/// Strength and softness of the shown shadow, relative to the truth. The real shadow is removed,
/// and the toy lit, independently of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShadowStyle {
    /// Strength of the shadow on the receivers, in linear light, within [`STRENGTH`]. Up to 1 it
    /// scales the light that the shadow removes: 0 shows no shadow. Beyond 1 it is the exponent of
    /// the remaining light: 2 is the true shadow laid over itself, which keeps its hue and is never
    /// blacker than black. It applies to the shadows of lights and of ambient light.
    pub strength: f64,
    /// Width of the lights, as the shadow shows it, over their own, within [`SOFTNESS`]: penumbrae
    /// scale with it, and 0 is the shadow of points. A point light keeps its hard shadow, and the
    /// ambient light's shadow does not change.
    pub softness: f64,
}

impl ShadowStyle {
    /// The true shadow.
    pub const TRUE: Self = Self {
        strength: 1.0,
        softness: 1.0,
    };

    /// Validates both numbers, whose fields are below `field`.
    pub fn check(&self, field: &str) -> Result<(), InputError> {
        let numbers = [
            ("strength", self.strength, &STRENGTH),
            ("softness", self.softness, &SOFTNESS),
        ];
        numbers.into_iter().try_for_each(|(name, value, range)| {
            InputError::at(&format!("{field}.{name}"), check::number(value, range)).map(|_| ())
        })
    }
}

impl Default for ShadowStyle {
    fn default() -> Self {
        Self::TRUE
    }
}
