//! Easing: the share of a movement at a share of its time.

use serde::{Deserialize, Serialize};

/// The easing of a clip, or of the way from key to key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Ease {
    /// Constant speed.
    #[default]
    Linear,
    /// Rising speed.
    In,
    /// Falling speed.
    Out,
    /// Speed that rises, then falls.
    InOut,
}

impl Ease {
    /// The share of the way at a share of the time, both from 0 to 1.
    #[must_use]
    pub fn way(self, time: f64) -> f64 {
        match self {
            Self::Linear => time,
            Self::In => time * time,
            Self::Out => time * (2.0 - time),
            Self::InOut => time * time * (3.0 - 2.0 * time),
        }
    }
}
