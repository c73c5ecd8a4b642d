//! Degraded modes, in words.

use std::fmt;

/// A degraded mode: the picture is the best that can be had, for a reason.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// No light is listed, and none is estimated: the camera frame passes through.
    NoLight,
    /// There is no plate, and the preset cannot do without: the camera frame passes through.
    NoPlate,
    /// There is no plate: the scene without the toy is estimated from the frame.
    PlateEstimated,
    /// The plates show only a part of the work region; the rest is estimated from the frame, or
    /// stays as it is with a preset that needs a plate.
    PlatePartial {
        /// Share that they show, from 0 to 1.
        fraction: f64,
    },
    /// More receivers than this version moves shadows on.
    ReceiversLeftOut {
        /// Those whose shadow stays as photographed.
        names: Vec<String>,
    },
    /// More lights than are moved.
    LightsLeftOut {
        /// How many shadows stay as photographed.
        n_lights: usize,
    },
    /// A light does not stand above the receiver, so it casts no shadow there.
    LightBelowReceiver {
        /// Its index in the list of lights: the frame's own, or the scene's.
        light: usize,
    },
    /// Too little real shadow is seen for the intensities of the lights.
    FaintShadow {
        /// Energy of the lights' columns over that of the plate.
        contrast: f32,
    },
    /// Intensities of some lights are under-constrained, and a prior decides: their shadow falls together with that of others, or
    /// where the camera does not see it.
    LightsUnderConstrained {
        /// Their indices in the list of lights: the frame's own, or the scene's.
        lights: Vec<usize>,
    },
    /// No umbra of the real shadow is seen: preset `paper` has nothing to sample, and draws no shadow.
    NothingToSample,
    /// New shadows fall or overlap as no real ones are seen to: preset `paper` samples where the lights differ least.
    ShadowsUnseen {
        /// What would have to be seen.
        unseen: Vec<UnseenShadow>,
    },
    /// The camera sees what the model cannot explain.
    Outlier(Outlier),
    /// The toy and its shadow are out of the picture.
    OutOfPicture,
    /// The camera's centre is not above the receiver.
    CameraBelowReceiver,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoLight => f.write_str("no light is listed: the camera frame passes through"),
            Self::NoPlate => {
                f.write_str("there is no plate, which this preset needs: the camera frame passes through")
            }
            Self::PlateEstimated => {
                f.write_str("there is no plate: the place behind toy and shadow is estimated from the frame")
            }
            Self::PlatePartial { fraction } => write!(
                f,
                "the plates show {:.0} % of what is worked on: the rest is estimated, or stays as it is with a preset that needs a plate",
                100.0 * fraction
            ),
            Self::ReceiversLeftOut { names } => {
                write!(
                    f,
                    "the shadow on {} stays as photographed: the preset handles fewer receivers",
                    names.join(", ")
                )
            }
            Self::LightsLeftOut { n_lights } => {
                write!(
                    f,
                    "the shadows of the last {n_lights} lights stay as photographed: the preset handles fewer"
                )
            }
            Self::LightBelowReceiver { light } => {
                write!(f, "light {light} is above none of the receivers and is left out")
            }
            Self::FaintShadow { contrast } => write!(
                f,
                "little real shadow is seen (contrast {contrast:.4}): the strength of the new one is partly assumed"
            ),
            Self::LightsUnderConstrained { lights } => write!(
                f,
                "the real shadow does not tell the strength of {} by itself: lights are taken to be alike",
                lights
                    .iter()
                    .map(|light| format!("light {light}"))
                    .collect::<Vec<_>>()
                    .join(" and ")
            ),
            Self::NothingToSample => f.write_str(
                "no umbra of the real shadow is seen: no new shadow is drawn, for want of samples",
            ),
            Self::ShadowsUnseen { unseen } => write!(
                f,
                "no real shadow is seen of {}: the new one there has the shade of others",
                unseen
                    .iter()
                    .map(ToString::to_string)
                    .collect::<Vec<_>>()
                    .join(", ")
            ),
            Self::Outlier(unknown) => unknown.fmt(f),
            Self::OutOfPicture => f.write_str("the toy and its shadow are out of the picture"),
            Self::CameraBelowReceiver => {
                f.write_str("the camera is not above the receiver: the camera frame passes through")
            }
        }
    }
}

/// A place on a receiver that just some lights do not reach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnseenShadow {
    /// Index of the receiver in the scene's list.
    pub receiver: usize,
    /// Indices in the list of lights: the frame's own, or the scene's.
    pub lights: Vec<usize>,
}

impl fmt::Display for UnseenShadow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lights: Vec<_> = self.lights.iter().map(ToString::to_string).collect();
        write!(
            f,
            "light {} alone on receiver {}",
            lights.join(" + "),
            self.receiver
        )
    }
}

/// What stays as it was photographed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outlier {
    /// A thing of its own colour, such as a hand.
    Object,
    /// What looks like the shadow of a light that is not listed.
    Shadow,
}

impl fmt::Display for Outlier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Object => {
                "something that the plate does not show lies on the receiver: it stays as photographed"
            }
            Self::Shadow => "a shadow is there that no listed light casts: it stays as photographed",
        })
    }
}
