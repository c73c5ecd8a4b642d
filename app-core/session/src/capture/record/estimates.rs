//! What is only guessed: a platform's estimate of the light, and how far what is given may be off.

use serde::{Deserialize, Serialize};

#[cfg(feature = "schema")]
use {crate::capture::rules::Within, app_scene::scene::check, schemars::JsonSchema};

/// What a platform estimates of the light.
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
    /// Intensity of the surroundings in the platform's own unit: about 1000 is well lit with ARKit.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::INTENSITY)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient_intensity: Option<f64>,
    /// Colour temperature of the surroundings, kelvin; about 6500 is neutral.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::KELVIN)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_temperature: Option<f64>,
    /// Radiance from all around in world space: red, green and blue of each of nine coefficients, as ARCore orders them,
    /// linear, relative to the exposure. Their (degree, order) are (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) to (2, 2),
    /// real and without the Condon-Shortley phase: those of degree 1 go with y, z and x.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::HARMONIC)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spherical_harmonics: Option<[f64; 27]>,
}

/// How far what is given may be off, at most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct UncertaintyRecord {
    /// Of the toy's place in each frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toy: Option<PoseUncertaintyRecord>,
    /// Of the camera of each frame and plate, but for the first plate's, which is held.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<PoseUncertaintyRecord>,
    /// Of each light that is listed; those that no list has are looked for everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<LightUncertaintyRecord>,
    /// Whether where the receivers are is a guess, as for photographs that were taken without a tracker: they are laid, as one, with the
    /// most level of them under the feet of the toy, which is found against the camera alone. False without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub receivers_guessed: Option<bool>,
}

/// How far toy or camera may be off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct PoseUncertaintyRecord {
    /// How far the middle of the toy, or the camera, may be elsewhere, metres; 0 where its place is known. A toy that
    /// rests on a receiver is looked for as far on it, up to one and a half of its radii. Without it nothing is bounded:
    /// what is near is found, a toy within some centimetres, a camera within ten.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<f64>,
    /// How far it may be turned, about whatever axis, degrees; 0 where that is known. A toy that rests on a receiver is
    /// looked for in all turns up to it, a camera up to 6 degrees. Without it nothing is bounded: a toy that rests is
    /// found within some 60 degrees about the receiver's normal, others within some, a camera within two.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_DEG)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation_deg: Option<f64>,
}

/// How far a light may be off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct LightUncertaintyRecord {
    /// How far its direction, as seen from the toy, may be off, degrees; 0 where it is known. It is looked for as far, up
    /// to 60 degrees. Without it nothing is bounded, and it is looked for within 14 degrees.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_DEG)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// Largest ratio of true distance and given one, or the other way round; 1 where it is known. Not bounded without it:
    /// about 1.3.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_RATIO)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_ratio: Option<f64>,
    /// The same of its size as seen from the toy; a point's is not bounded by more than 1. Not bounded without it: about
    /// 1.7.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_RATIO)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_ratio: Option<f64>,
}
