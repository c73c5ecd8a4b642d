//! Presets: how much work a frame may cost.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// A named balance of speed and accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// The default.
    #[default]
    Balanced,
}

impl Preset {
    /// Every preset there is.
    pub const ALL: &[Self] = &[Self::Balanced];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Balanced => "balanced",
        }
    }

    /// What the preset spends.
    #[must_use]
    pub fn settings(self) -> Settings {
        match self {
            Self::Balanced => Settings {
                n_light_points: 64,
                n_ambient_directions: 64,
                ambient_divisor: 4,
            },
        }
    }
}

/// What a preset spends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Points over each light, a multiple of 16 up to 64, of a light whose penumbra is wider than a pixel.
    pub n_light_points: usize,
    /// Directions of ambient light, a multiple of 16 up to 64.
    pub n_ambient_directions: usize,
    /// Region pixels per texel of the ambient map, along each side.
    pub ambient_divisor: u32,
}

/// A preset asked for by a name that it does not have.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("preset \"{asked}\" is not built; there is {known}")]
pub struct UnknownPreset {
    /// What was asked for.
    pub asked: String,
    /// The names there are.
    pub known: String,
}

impl FromStr for Preset {
    type Err = UnknownPreset;

    fn from_str(name: &str) -> Result<Self, UnknownPreset> {
        Self::ALL
            .iter()
            .copied()
            .find(|preset| preset.name() == name)
            .ok_or_else(|| UnknownPreset {
                asked: name.to_owned(),
                known: Self::ALL
                    .iter()
                    .map(|preset| preset.name())
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
