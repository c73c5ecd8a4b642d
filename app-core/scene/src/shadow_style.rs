//! The shown shadow to taste: how strong and how soft it is, over what the real one tells.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::scene::{InputError, check};

/// How strong the shown shadow may be: with 4 a shadow that leaves half of the light leaves a sixteenth.
pub const STRENGTH: RangeInclusive<f64> = 0.0..=4.0;
/// How soft it may be: of a wider light a part would often lie below the table.
pub const SOFTNESS: RangeInclusive<f64> = 0.0..=4.0;

/// Strength and softness of the shadow that is shown, 1 being the truth. The real shadow is removed, and the toy is lit, as they are
/// without it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShadowStyle {
    /// How strong the shadow is on the receivers, in linear light, within [`STRENGTH`]. Up to 1 it is the share of the light that the
    /// shadow takes of what it truly takes: 0 shows none. Beyond, the part that it leaves is taken to this power: 2 is the true shadow
    /// laid over itself, which keeps its hue and is never blacker than black. It holds for the shadow of the lights and for that of the
    /// ambient light.
    pub strength: f64,
    /// Width of the lights, as the shadow shows it, over their own, within [`SOFTNESS`]: penumbrae are as much wider, and 0 is the
    /// shadow of points. A light that is listed as a point keeps its hard shadow, and the ambient light's stays as it is.
    pub softness: f64,
}

impl ShadowStyle {
    /// The shadow as it truly is.
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
