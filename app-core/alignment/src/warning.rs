//! Failures of the alignment, in words.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::no_light::NoLight;

/// A part of the frame that stays as given, for a reason.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AlignmentWarning {
    /// The toy's outline does not fit the picture's, and no pose was found for which it does.
    Misaligned {
        /// Root mean square distance between the two, in pixels; each part of it counts at most
        /// two.
        outline_px: f64,
    },
    /// The toy is not on the receiver that it was given on.
    OffReceiver {
        /// Height of the foot farthest from it, in metres; negative if it is below.
        height_m: f64,
        /// Angle between the receiver and the plane of the toy's feet, in radians.
        lean_rad: f64,
    },
    /// The outline of the toy's model differs from the toy's.
    ModelDiffers {
        /// Root mean square difference along some centimetres, in pixels.
        model_px: f64,
        /// Root mean square displacement of the adapted model, in metres; `None` if it is not
        /// adapted.
        displaced_m: Option<f64>,
    },
    /// No light was found by the toy's shadow.
    LightNotFound {
        /// The reason.
        reason: NoLight,
    },
    /// No light was found by the toy's shadow, and a wide one is assumed.
    LightAssumed {
        /// The fraction of ambient light's residual that it explains, from 0 to 1.
        explained: f64,
    },
    /// The toy's shadow differs from that of the listed lights, and from that of any others: the
    /// list stays.
    ListUnexplained {
        /// The fraction of the shadow that they leave unexplained, from 0 to 1.
        unexplained: f64,
    },
    /// The shadows have changed, and no lights were found that explain them.
    LightsChanged {
        /// The fraction of the shadows that no light explains, from 0 to 1.
        unexplained: f64,
    },
    /// The focal length was requested, and toy and shadows do not determine it.
    FocalLengthUnconstrained,
    /// The scale of the world was requested, and toy and shadows do not determine it.
    WorldScaleUnconstrained,
}

impl fmt::Display for AlignmentWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LightNotFound { reason } => write!(f, "no light is found by the toy's shadow: {reason}"),
            Self::LightAssumed { explained } => write!(
                f,
                "no light is found by the toy's shadow: a wide one is assumed, which explains {:.0} % of the error with ambient light alone; list the lights, or photograph a lens",
                100.0 * explained
            ),
            Self::ListUnexplained { unexplained } => write!(
                f,
                "{:.0} % of the toy's shadow is not where the listed lights cast it, and no lights are found that do: check the list, and whether a hand or an object that is not listed as a receiver catches the shadow or casts one",
                100.0 * unexplained
            ),
            Self::LightsChanged { unexplained } => write!(
                f,
                "{:.0} % of the toy's shadow is not where the lights cast it: one was moved or switched on, or something else casts a shadow there",
                100.0 * unexplained
            ),
            Self::Misaligned { outline_px } => write!(
                f,
                "the toy's outline is {outline_px:.1} pixels or more from the picture's, and no pose is found that fits: check world_from_object, and that physical_pose is the toy's"
            ),
            Self::OffReceiver { height_m, lean_rad } => {
                let side = if *height_m < 0.0 { "beneath" } else { "above" };
                write!(
                    f,
                    "the toy does not stand on its receiver: a foot is {:.1} mm {side} it, and the toy leans by {:.1} degrees: check the receiver's world_from_plane, and toy.resting",
                    1e3 * height_m.abs(),
                    lean_rad.to_degrees()
                )
            }
            Self::ModelDiffers {
                model_px,
                displaced_m,
            } => {
                write!(f, "the toy's outline differs from that of its model by {model_px:.1} pixels: ")?;
                match displaced_m {
                    Some(displaced_m) => write!(
                        f,
                        "the model was adapted to it by {:.1} mm, along its outline",
                        1e3 * displaced_m
                    ),
                    None => f.write_str("the model is not quite this toy, and its rim will show it"),
                }
            }
            Self::FocalLengthUnconstrained => f.write_str(
                "the focal length was requested, but toy and shadow do not constrain it: the given one is used",
            ),
            Self::WorldScaleUnconstrained => f.write_str(
                "the scale of the world was requested, but toy and shadow do not constrain it: the given one is used",
            ),
        }
    }
}

impl Serialize for AlignmentWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
