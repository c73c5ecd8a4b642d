//! How a way is gone over its time.

use serde::{Deserialize, Serialize};

/// How a clip, or the way from key to key, speeds up and slows down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Ease {
    /// Not at all.
    #[default]
    Linear,
    /// It speeds up.
    In,
    /// It slows down.
    Out,
    /// It speeds up and slows down.
    InOut,
}

impl Ease {
    /// The part of the way at a part of the time, both from 0 to 1.
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
