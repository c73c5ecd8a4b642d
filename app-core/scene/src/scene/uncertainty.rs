//! How far what is given may be off.

use super::check::{self, InputError};

/// How far camera, toy and lights may be from where they are given, at most, as far as whoever gives them knows.
///
/// Alignment moves nothing farther than that, and looks as far where it is more than alignment looks by itself: see each number.
/// Zero holds what is given as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Of the toy in each frame.
    pub toy: PoseUncertainty,
    /// Of the camera of each frame and plate, but for the first plate's, which is held.
    pub camera: PoseUncertainty,
    /// Of each light that is listed; those that no list has are looked for everywhere.
    pub lights: LightUncertainty,
    /// Whether where the receivers are is a guess, such as for photographs that were taken without a tracker. The toy is then found
    /// against the camera alone, and all receivers are laid, as one, with the most level of them under the feet of the toy.
    pub are_receivers_guessed: bool,
}

/// How far a pose may be off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseUncertainty {
    /// Distance in metres by which the middle of the toy, or the camera, may be elsewhere. Without it nothing is bounded: a toy is
    /// looked for some centimetres around, a camera is held back beyond ten. Of a toy that rests on a receiver more is looked through
    /// on the receiver.
    pub position_m: Option<f64>,
    /// Angle in radians by which it may be turned, about whatever axis, from 0 to pi. Without it nothing is bounded: a toy that rests on
    /// a receiver is looked for within 45 degrees about its normal, others within some; a camera within two. More is looked
    /// through of such a toy, all round, and of a camera up to six degrees.
    pub rotation_rad: Option<f64>,
}

/// How far a light may be off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightUncertainty {
    /// Angle in radians, as seen from the toy, from 0 to pi. Without it nothing is bounded, and lights are looked for within 14 degrees;
    /// more is looked through, up to 60 degrees.
    pub direction_rad: Option<f64>,
    /// Largest ratio of true distance and given one, or the other way round: 1 where the distance is known. Without it about 1.3.
    pub distance_ratio: Option<f64>,
    /// The same of the size as seen from the toy. Without it about 1.7.
    pub size_ratio: Option<f64>,
}

impl Uncertainty {
    /// Validates the numbers, whose fields are below `field`.
    pub(crate) fn check(&self, field: &str) -> Result<(), InputError> {
        let Self {
            toy, camera, lights, ..
        } = self;
        let numbers = [
            ("toy.position_m", toy.position_m, check::UNCERTAINTY_M),
            ("toy.rotation_rad", toy.rotation_rad, check::UNCERTAINTY_RAD),
            ("camera.position_m", camera.position_m, check::UNCERTAINTY_M),
            ("camera.rotation_rad", camera.rotation_rad, check::UNCERTAINTY_RAD),
            (
                "lights.direction_rad",
                lights.direction_rad,
                check::UNCERTAINTY_RAD,
            ),
            (
                "lights.distance_ratio",
                lights.distance_ratio,
                check::UNCERTAINTY_RATIO,
            ),
            ("lights.size_ratio", lights.size_ratio, check::UNCERTAINTY_RATIO),
        ];
        for (name, value, range) in numbers {
            if let Some(value) = value {
                let checked = check::number(value, &range).map(drop);
                InputError::at(&format!("{field}.{name}"), checked)?;
            }
        }
        Ok(())
    }
}
