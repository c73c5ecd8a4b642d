//! What could not be aligned, in words.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::no_light::NoLight;

/// A part of the frame that stays as it is given, for a reason.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AlignmentWarning {
    /// The toy's outline is not where the picture has it, and no pose was found that brings it there.
    Misaligned {
        /// Root mean square distance between the two, in pixels; no part of it counts as more than two.
        outline_px: f64,
    },
    /// The toy is not on the receiver that it was given on.
    OffReceiver {
        /// Of the foot that is farthest from it, in metres: above it, or, below 0, beneath it.
        height_m: f64,
        /// Between the receiver and the plane of the toy's feet, in radians.
        lean_rad: f64,
    },
    /// The outline of the toy's model is not that of the toy.
    ModelDiffers {
        /// Root mean square of what it is off by along some centimetres, in pixels.
        model_px: f64,
        /// Root mean square of what the model was displaced by, in metres, to have the toy's; none where it is shown as it is given.
        displaced_m: Option<f64>,
    },
    /// No light was found by the toy's shadow.
    LightNotFound {
        /// Why.
        reason: NoLight,
    },
    /// No light was found by the toy's shadow, and a wide one is assumed.
    LightAssumed {
        /// The part that it explains of what light from all around leaves of the picture, from 0 to 1.
        explained: f64,
    },
    /// The toy's shadow is not where the listed lights cast it, nor where any cast it that were found: none stand in for the list.
    ListUnexplained {
        /// The part of the shadow that they leave unexplained, from 0 to 1.
        unexplained: f64,
    },
    /// The shadows are no longer where the lights cast them, and no lights were found that do.
    LightsChanged {
        /// The part of the shadows that no light explains, from 0 to 1.
        unexplained: f64,
    },
    /// The focal length was asked for, and toy and shadows do not determine it.
    FocalLengthNotTold,
    /// The scale of the world was asked for, and toy and shadows do not determine it.
    WorldScaleNotTold,
}

impl fmt::Display for AlignmentWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LightNotFound { reason } => write!(f, "no light is found by the toy's shadow: {reason}"),
            Self::LightAssumed { explained } => write!(
                f,
                "no light is found by the toy's shadow: a wide one is assumed, which explains {:.0} % of what light from all around leaves; list the lights, or photograph a lens",
                100.0 * explained
            ),
            Self::ListUnexplained { unexplained } => write!(
                f,
                "{:.0} % of the toy's shadow is not where the listed lights cast it, and none are found that do: check the list, and whether something that is no listed receiver lies under the shadow",
                100.0 * unexplained
            ),
            Self::LightsChanged { unexplained } => write!(
                f,
                "{:.0} % of the toy's shadow is not where the lights cast it: one was moved or switched on, or something else casts a shadow there",
                100.0 * unexplained
            ),
            Self::Misaligned { outline_px } => write!(
                f,
                "the toy's outline is {outline_px:.1} pixels or more from that in the picture, and no pose is found that fits: check world_from_object, and that physical_pose is the toy's"
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
                        "the model was adapted to it by {:.1} mm, where the outline tells it",
                        1e3 * displaced_m
                    ),
                    None => f.write_str("the model is not quite this toy, and its rim will show it"),
                }
            }
            Self::FocalLengthNotTold => f.write_str(
                "the focal length was asked for, but toy and shadow do not tell it: that given is taken",
            ),
            Self::WorldScaleNotTold => f.write_str(
                "the scale of the world was asked for, but toy and shadow do not tell it: that given is taken",
            ),
        }
    }
}

impl Serialize for AlignmentWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
