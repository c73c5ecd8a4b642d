//! A light probe and its pictures.

use serde::{Deserialize, Serialize};

use super::IntrinsicsRecord;

#[cfg(feature = "schema")]
use {
    crate::capture::rules::Within,
    app_scene::scene::{MAX_FACETS, MAX_FURTHER_PICTURES, check},
    schemars::JsonSchema,
};

/// A light probe: all kinds of it in one record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ProbeRecord {
    /// Kind of the probe.
    pub kind: ProbeKind,
    /// From the probe's space, metres, to world. Rigid. A lens is a disc around the origin in local y = 0, its normal
    /// local +Y; a ball is around the origin.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_lens: [f64; 16],
    /// Radius of disc or ball, metres.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    pub radius: f64,
    /// Focal length of a lens that spreads light like a convex mirror, metres: at a distance r from
    /// its axis the slope is half of atan(r / focal length). Without one, or with null, its slopes
    /// are the hemisphere's. No effect on a ball.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub focal_length: Option<f64>,
    /// Calibrated slopes of a lens's facets, from the axis outwards; they have priority over a
    /// focal length. Without any, the focal length applies, or the hemisphere. No effect on a ball.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_FACETS)))]
    pub facets: Vec<FacetRecord>,
    /// Path of a picture of it in the session's folder, PNG or JPEG of the session's size, underexposed.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub image: String,
    /// Exposure of that picture over that of a frame.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE_RATIO)))]
    pub exposure_ratio: f64,
    /// Projection of its camera; the first frame's by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<IntrinsicsRecord>,
    /// Pose of its camera; the first frame's by default. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_camera: Option<[f64; 16]>,
    /// Further pictures, in the order of time: the distance of a light is estimated from several
    /// views. Lights are those of the last picture that shows the probe.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_FURTHER_PICTURES)))]
    pub pictures: Vec<ProbePictureRecord>,
}

/// Kind of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ProbeKind {
    /// A flat reflective Fresnel lens, a mirror ball pressed flat: at disc position (x, z) / radius its normal is that of
    /// the hemisphere above that point, unless `facets` or `focal_length` say otherwise.
    FresnelLens,
    /// A mirror ball.
    MirrorBall,
}

/// The slope of a lens's facet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct FacetRecord {
    /// Distance from the axis over the lens's radius; above that of the entry before. Slopes are
    /// linear between entries, and 0 on the axis.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::OF_RADIUS)))]
    pub at: f64,
    /// Angle between the facet's normal, which leans outwards, and the lens's, degrees.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SLOPE_DEG)))]
    pub slope_deg: f64,
}

/// A further picture of the probe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ProbePictureRecord {
    /// Path of the picture in the session's folder, PNG or JPEG of the session's size, underexposed.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub image: String,
    /// Exposure of the picture over that of a frame; that of the probe's `image` by default.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE_RATIO)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_ratio: Option<f64>,
    /// Projection of its camera; the session's by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<IntrinsicsRecord>,
    /// Pose of its camera. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_camera: [f64; 16],
    /// Pose of the probe then; that in its `image` by default.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_lens: Option<[f64; 16]>,
}
