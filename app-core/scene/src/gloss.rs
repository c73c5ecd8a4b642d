//! Gloss of the toy: its specular reflection, in addition to the diffuse one of its base colour.

use std::ops::RangeInclusive;

use crate::scene::{InputError, check};

/// Number of materials that have a strength of their own; all later ones share the last.
pub const N_GLOSSES: usize = 8;
/// Range from a mirror, which is hardly one lobe, to a matt surface.
const ROUGHNESS: RangeInclusive<f64> = 0.01..=1.0;
/// Range from a matt surface to a mirror: smooth plastic, with strength 1, reflects a twenty-fifth.
const STRENGTH: RangeInclusive<f64> = 0.0..=25.0;
/// Roughness below which a toy mirrors its surroundings, of which only the lights are known.
const MIRROR_ROUGHNESS: f32 = 0.03;
/// Strength above which the surface is neither plastic nor lacquer.
const METAL_STRENGTH: f32 = 2.5;

/// One lobe of specular reflection.
///
/// It reflects the light that the fit estimates from the diffuse reflection, so two kinds of
/// numbers suffice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Roughness of the surface: the root mean square slope of its facets, times the square root of 2.
    pub roughness: f32,
    /// Strength of each material, in the order of the toy's file: reflectance relative to that of a
    /// smooth dielectric of refractive index 1.5. 0 is matt.
    pub strengths: [f32; N_GLOSSES],
}

impl Gloss {
    /// A matt toy.
    pub const NONE: Self = Self {
        roughness: 1.0,
        strengths: [0.0; N_GLOSSES],
    };

    /// Whether the whole toy is matt.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.strongest() == 0.0
    }

    /// The strength of its glossiest material.
    #[must_use]
    pub fn strongest(&self) -> f32 {
        self.strengths.iter().copied().fold(0.0, f32::max)
    }

    /// Whether such a toy visibly reflects more than a few lights and an even sky.
    #[must_use]
    pub fn is_beyond_model(&self) -> bool {
        let strongest = self.strongest();
        strongest > METAL_STRENGTH || strongest > 0.0 && self.roughness < MIRROR_ROUGHNESS
    }

    pub(crate) fn check(&self, field: &str) -> Result<(), InputError> {
        let within = |name: &str, value: f32, range: &RangeInclusive<f64>| {
            InputError::at(&format!("{field}.{name}"), check::number(f64::from(value), range)).map(|_| ())
        };
        within("roughness", self.roughness, &ROUGHNESS)?;
        let mut strengths = self.strengths.iter().enumerate();
        strengths
            .try_for_each(|(index, strength)| within(&format!("strengths[{index}]"), *strength, &STRENGTH))
    }
}

impl Default for Gloss {
    fn default() -> Self {
        Self::NONE
    }
}
