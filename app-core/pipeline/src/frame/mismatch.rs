//! What pictures should show and do not, in words.

use std::fmt;

/// What the pictures of the latest view do not show as the scene says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mismatch {
    /// Where the listed lights should cast the real shadow, the picture is as bright as the plate.
    NoShadow {
        /// What the lights give of the plate's radiance, from 0 to 1.
        direct_fraction: f32,
    },
    /// The real shadow is too dark or too bright in the picture to be measured.
    ShadowUnreadable {
        /// Share of it, from 0 to 1.
        fraction: f64,
    },
    /// The plate is too dark or too bright to be compared with.
    PlateUnreadable {
        /// Share of the receivers' pixels, from 0 to 1.
        fraction: f64,
    },
    /// Where the real toy should be, the picture shows what the plate does.
    ToyNotSeen {
        /// Share of the toy's pixels, from 0 to 1.
        fraction: f64,
    },
    /// Red and blue are in another order in the picture than in the plate.
    RedAndBlueSwapped {
        /// How many times better the colours agree when they are swapped.
        times: f64,
    },
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoShadow { direct_fraction } => write!(
                f,
                "where the real shadow should be, the picture is as bright as the plate ({:.1} % is the lights'): check lights and toy, and whether a light is on",
                100.0 * direct_fraction
            ),
            Self::ShadowUnreadable { fraction } => write!(
                f,
                "{:.0} % of the real shadow is too dark or too bright in the picture to be measured: the strength of the new one is partly assumed; take it at another exposure",
                100.0 * fraction
            ),
            Self::PlateUnreadable { fraction } => write!(
                f,
                "{:.0} % of the plate is too dark or too bright to compare the picture with: take it again at another exposure",
                100.0 * fraction
            ),
            Self::ToyNotSeen { fraction } => write!(
                f,
                "the picture shows the plate where the real toy should be ({:.0} % of it): check whether it is there, and its pose",
                100.0 * fraction
            ),
            Self::RedAndBlueSwapped { times } => write!(
                f,
                "picture and plate agree {times:.1} times better with red and blue swapped: check the order of channels in both"
            ),
        }
    }
}
