//! Reasons why a scene has no light.

use std::fmt;

use serde::{Serialize, Serializer};

/// The reason why no light was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoLight {
    /// The toy's pose is not known well enough.
    PoseUnknown,
    /// Too little of the receivers is visible beside the toy.
    ReceiversUnseen,
    /// No light explains enough of the picture: the light is ambient, or too little of a shadow is
    /// visible.
    NoneDominant,
}

impl fmt::Display for NoLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PoseUnknown => "the toy's pose is not known well enough",
            Self::ReceiversUnseen => "too little of the receivers is visible beside the toy",
            Self::NoneDominant => "no light stands out, or too little of its shadow is visible",
        })
    }
}

impl Serialize for NoLight {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
