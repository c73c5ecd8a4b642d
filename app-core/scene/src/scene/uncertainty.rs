//! Uncertainty of the given poses and lights.

use super::check::{self, InputError};

/// Largest errors of the given camera, toy and lights, if their source knows them.
///
/// Alignment changes nothing by more than that, and extends its default search to that range: see
/// each number. Zero fixes a given value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Uncertainty of the toy in each frame.
    pub toy: PoseUncertainty,
    /// Uncertainty of the camera of each frame and plate except the first plate's, which is fixed.
    pub camera: PoseUncertainty,
    /// Uncertainty of each listed light; unlisted lights are searched everywhere.
    pub lights: LightUncertainty,
    /// Whether the receivers are a guess, for example for photographs without a tracker. The toy is
    /// then located relative to the camera alone, and all receivers are moved as one until the most
    /// level of them is under the feet of the toy.
    pub are_receivers_guessed: bool,
}

/// Uncertainty of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseUncertainty {
    /// Largest error of the position of the toy's centre, or of the camera, in metres. `None` sets
    /// no bound: a toy is searched within some centimetres, and a camera is regularised beyond ten.
    /// For a toy that rests on a receiver the search extends along the receiver.
    pub position_m: Option<f64>,
    /// Largest error of the rotation in radians, about any axis, from 0 to pi. `None` sets no
    /// bound: a toy that rests on a receiver is searched from turns by up to 45 degrees about its
    /// normal, others within some; a camera within two. A larger value extends the search of such a toy to all
    /// directions, and of a camera to six degrees.
    pub rotation_rad: Option<f64>,
}

/// Uncertainty of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightUncertainty {
    /// Angle in radians, as seen from the toy, from 0 to pi. `None` sets no bound, and lights are
    /// searched within 14 degrees; a larger value extends the search up to 60 degrees.
    pub direction_rad: Option<f64>,
    /// Largest ratio of true and given distance, or the inverse: 1 if the distance is known. `None`
    /// stands for about 1.3.
    pub distance_ratio: Option<f64>,
    /// The same for the size as seen from the toy. `None` stands for about 1.7.
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
