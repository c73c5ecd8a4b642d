//! Uncertain data: a platform's light estimate, and the uncertainty of given values.

use serde::{Deserialize, Serialize};

#[cfg(feature = "schema")]
use {crate::capture::rules::Within, app_scene::scene::check, schemars::JsonSchema};

/// A platform's light estimate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct LightEstimateRecord {
    /// From the scene towards the main light, in world space; of any length of 1e-9 or more.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_to_light: Option<[f64; 3]>,
    /// Intensity of the main light: red, green and blue, linear, relative to the exposure.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::INTENSITY)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intensity: Option<[f64; 3]>,
    /// Intensity of the surroundings in the platform's own unit: with ARKit, about 1000 in a
    /// well-lit room.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::INTENSITY)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient_intensity: Option<f64>,
    /// Colour temperature of the surroundings, kelvin; about 6500 is neutral.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::KELVIN)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_temperature: Option<f64>,
    /// Radiance of the surroundings in world space: red, green and blue of each of nine
    /// coefficients, in ARCore's order, linear, relative to the exposure. Their (degree, order) are
    /// (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) to (2, 2), real and without the Condon-Shortley
    /// phase: the coefficients of degree 1 belong to y, z and x.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::HARMONIC)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spherical_harmonics: Option<[f64; 27]>,
}

/// Largest errors of given values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct UncertaintyRecord {
    /// Uncertainty of the toy's pose in each frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toy: Option<PoseUncertaintyRecord>,
    /// Uncertainty of the camera of each frame and plate except the first plate's, which is fixed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<PoseUncertaintyRecord>,
    /// Uncertainty of each listed light; unlisted lights are searched everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<LightUncertaintyRecord>,
    /// Whether the receivers are a guess, for example for photographs without a tracker: they are
    /// moved as one until the most level of them is under the feet of the toy, which is located
    /// relative to the camera alone. False by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub receivers_guessed: Option<bool>,
}

/// Uncertainty of toy or camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct PoseUncertaintyRecord {
    /// Largest error of the position of the toy's centre, or of the camera, metres; 0 if the
    /// position is known. A toy that rests on a receiver is searched within it on the receiver, up
    /// to one and a half of its radii. By default nothing is bounded: a toy is searched within some
    /// centimetres, a camera within ten.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// Largest error of the rotation, about any axis, degrees; 0 if it is known. A toy that rests
    /// on a receiver is searched within it in all directions, a camera up to 6 degrees. By default
    /// nothing is bounded: a toy that rests is searched within some 60 degrees about the
    /// receiver's normal, others within some, a camera within two.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_DEG)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation_deg: Option<f64>,
}

/// Uncertainty of a light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct LightUncertaintyRecord {
    /// Largest error of its direction, as seen from the toy, degrees; 0 if it is known. It is
    /// searched within that, up to 60 degrees. By default nothing is bounded, and it is searched
    /// within 14 degrees.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_DEG)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// Largest ratio of true and given distance, or the inverse; 1 if it is known. About 1.3 by
    /// default.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_RATIO)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_ratio: Option<f64>,
    /// The same for its size as seen from the toy; a point light has no bound other than 1. About
    /// 1.7 by default.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_RATIO)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_ratio: Option<f64>,
}
