//! The records of `capture.json`: the one definition of the format, by which all who read or write sessions do so.
//! Their values are checked by the reader alone.
//!
//! What stands at a field describes it in the format's schema, too: type and unit, space, convention. Matrices are
//! `a_from_b`, column-major. A range is that of the check.

mod estimates;
mod probe;

use serde::{Deserialize, Serialize};

#[cfg(feature = "schema")]
use {
    super::rules::{Within, needs_of_its_kind},
    app_scene::lens,
    app_scene::scene::{MAX_SCENE_PLATES, check},
    schemars::JsonSchema,
};

pub use estimates::{LightEstimateRecord, LightUncertaintyRecord, PoseUncertaintyRecord, UncertaintyRecord};
pub use probe::{FacetRecord, ProbeKind, ProbePictureRecord, ProbeRecord};

/// What `format` has to say.
pub(super) const FORMAT: &str = "shadow-capture";
/// The one version that is read.
pub(super) const VERSION: u64 = 1;

/// `capture.json` of a `shadow-capture` folder, version 1. World space is right-handed, +Y up, metres. A matrix `a_from_b`
/// takes points of b to a; its 16 numbers are column-major. The centre of the first pixel is at (0.5, 0.5).
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(title = "shadow-capture"))]
pub struct Index {
    /// Which format it is.
    #[serde(flatten)]
    pub header: Header,
    /// What is read.
    #[serde(flatten)]
    pub capture: CaptureRecord,
    /// What is not.
    #[serde(flatten)]
    pub remarks: Remarks,
}

impl From<CaptureRecord> for Index {
    /// Without remarks.
    fn from(capture: CaptureRecord) -> Self {
        Self {
            header: Header::default(),
            capture,
            remarks: Remarks::default(),
        }
    }
}

/// Keys for people, which the reader skips like any that it does not know.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct Remarks {
    /// What is seen, for people. Not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Whose work toy and pictures are, and under which licences. Not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub credits: Option<String>,
    /// Unit of all lengths, which is the metre whatever stands here. Not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
}

/// Format and version, which decide whether the rest can be read at all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct Header {
    /// Name of the format: `shadow-capture`. Any other is refused.
    #[cfg_attr(feature = "schema", schemars(extend("const" = FORMAT)))]
    pub format: String,
    /// Version of the format: 1. Any other is refused.
    #[cfg_attr(feature = "schema", schemars(extend("const" = VERSION)))]
    pub version: u64,
}

impl Default for Header {
    /// Those that are read.
    fn default() -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
        }
    }
}

/// All of the index that is read, but format and version.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct CaptureRecord {
    /// Name for people; may be empty.
    pub name: String,
    /// Columns of every picture of the session, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SIDE_PX)))]
    pub width: u32,
    /// Rows of every picture of the session, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SIDE_PX)))]
    pub height: u32,
    /// Transfer function of all photographs.
    pub encoding: Encoding,
    /// Projection of every camera that has none of its own. A pinhole without distortion: the point (x, y, z) of camera
    /// space is seen at u = cx + fx x / -z, v = cy - fy y / -z. Where a lens is given, it moves that place.
    pub intrinsics: IntrinsicsRecord,
    /// Distortion of all photographs, each about its own principal point; a pinhole where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens: Option<LensRecord>,
    /// The toy: its model, where it really stands and in which pose.
    pub toy: ToyRecord,
    /// Planes that catch the shadow, in any order; shadows are moved on the four nearest to the toy.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub receivers: Vec<ReceiverRecord>,
    /// Lights whose shadows are moved, in any order; those beyond the fourth are left out, with a warning. Without any,
    /// the probe tells them, or alignment looks for them by the toy's shadow; else the toy moves in light from all around, with a warning.
    #[serde(default)]
    pub lights: Vec<LightRecord>,
    /// Plates: photographs of the place before the toy was put there, in any order. What none shows is estimated, or
    /// stays as photographed; without any, the place is estimated, or frames pass through (presets `paper` and `flat`).
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_SCENE_PLATES)))]
    pub backgrounds: Vec<BackgroundRecord>,
    /// Camera frames, in the order they are shown.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub frames: Vec<FrameRecord>,
    /// A light probe that lay in the scene: it tells the lights where none is listed, and alignment corrects them by the
    /// toy's shadow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probe: Option<ProbeRecord>,
    /// How far camera, toy and lights may be off, at most: alignment moves nothing farther than that. Without it nothing
    /// is bounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<UncertaintyRecord>,
}

/// How photographs encode light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// sRGB codes (IEC 61966-2-1) of 8 bit.
    Srgb,
}

/// Projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct IntrinsicsRecord {
    /// Focal length along the picture's rows, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::FOCAL_PX)))]
    pub fx: f64,
    /// Focal length along the picture's columns, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::FOCAL_PX)))]
    pub fy: f64,
    /// Principal point, pixels to the right of the picture's left border.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::POSITION_PX)))]
    pub cx: f64,
    /// Principal point, pixels below the picture's top border.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::POSITION_PX)))]
    pub cy: f64,
}

/// Radial distortion. With x = (u - cx) / fx, y = (v - cy) / fy and r2 = x x + y y, what a pinhole sees at (x, y) is in the
/// photograph at (1 + k1 r2 + k2 r2 r2) (x, y).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct LensRecord {
    /// Coefficient of r2: below 0 a barrel, above it a cushion.
    #[cfg_attr(feature = "schema", schemars(transform = Within(lens::COEFFICIENT)))]
    pub k1: f64,
    /// Coefficient of r2 r2; 0 where there is none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(lens::COEFFICIENT)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k2: Option<f64>,
}

/// The toy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ToyRecord {
    /// Path of the model, glTF 2.0, in the session's folder.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub file: String,
    /// Where the real toy stands: from the model's scene space, in whatever unit, to world, metres. A rotation, a
    /// translation and one scale for all axes, from 1e-6 to 1e6, such as 0.001 for a model in millimetres.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_object: [f64; 16],
    /// Pose that the real toy was made in, the same in all frames.
    pub physical_pose: PoseRecord,
    /// Whether the toy rests on the receiver below it: true holds it there while it is aligned, false lets it float. Without it, a toy
    /// that is given close to a receiver rests there unless the picture speaks against it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resting: Option<bool>,
}

/// A pose of the toy; by default nodes stand as authored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct PoseRecord {
    /// Animation of the model: its name, or `#N` for the N-th of the file, counted from 0; a name wins, an unknown one is
    /// refused. Without one, or with null, nodes stand as authored.
    pub clip: Option<String>,
    /// Moment of the clip, seconds from its begin. Beyond its end the last moment is shown, with a warning. Needed
    /// without a clip, too, and then of no effect.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::CLIP_TIME_SECS)))]
    pub time: f64,
}

/// A rectangle that catches the shadow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ReceiverRecord {
    /// Name for people; may be empty.
    pub name: String,
    /// From the receiver's plane space, metres, to world. Rigid. Local y = 0 is the plane, local +Y its normal, on the
    /// side that is lit and seen.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_plane: [f64; 16],
    /// Half the rectangle's sides along local x and z, around the plane's origin, metres.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    pub half_extent: [f64; 2],
    /// How the receiver looks.
    pub surface: SurfaceRecord,
}

/// How a receiver looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SurfaceRecord {
    /// One colour all over.
    Uniform,
    /// Its colour varies.
    Textured,
}

/// All kinds of light in one record: an enum tagged by `kind` would lose the path of a bad field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(description = "A light.", transform = needs_of_its_kind))]
pub struct LightRecord {
    /// What the light is, which decides which other keys are needed; those of another kind are not used, but of their
    /// type.
    pub kind: LightKind,
    /// Centre of a sphere, metres in world space.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::LIGHT_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// Radius of a sphere, metres. Zero is a point.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::RADIUS_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// From the scene towards a directional light, in world space; of any length of 1e-9 or more.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_to_light: Option<[f64; 3]>,
    /// Half the angle that a directional light's disc fills, degrees. The sun's is 0.27.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::ANGULAR_RADIUS_DEG)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_radius_deg: Option<f64>,
}

/// What a light is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// A bulb; needs `position` and `radius`.
    #[default]
    Sphere,
    /// A light too far away for its distance to matter; needs `direction_to_light` and `angular_radius_deg`.
    Directional,
}

/// A plate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct BackgroundRecord {
    /// Path of the photograph in the session's folder, PNG or JPEG of the session's size. Plates that name one file
    /// share it.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub image: String,
    /// Projection of the camera that took it; that of the session where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<IntrinsicsRecord>,
    /// Pose of the camera that took it: from camera space (+X right, +Y up, looks along -Z, metres) to world. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_camera: [f64; 16],
}

/// A camera frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct FrameRecord {
    /// When the frame was taken, seconds from an origin of the session's own.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::TIME_SECS)))]
    pub time: f64,
    /// Path of the camera's picture of the real toy in the session's folder, PNG or JPEG of the session's size. Frames
    /// may repeat a picture.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub image: String,
    /// Projection of the camera in this frame, such as of one that focuses; that of the session where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<IntrinsicsRecord>,
    /// Where the real toy stands in this frame, by the rules of the toy's own: for a toy that is moved during the
    /// session. That of the toy where there is none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_object: Option<[f64; 16]>,
    /// Where the toy is to be shown in this frame, by the rules of the toy's own `world_from_object`; where the real toy
    /// stands if there is none. It is a place in the world: a correction of the real toy's does not move it.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_shown: Option<[f64; 16]>,
    /// Exposure (duration times sensitivity) of the picture over that of the session's other frames; 1 where there is
    /// none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
    /// What the platform estimated of the light in this frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_estimate: Option<LightEstimateRecord>,
    /// Pose of the camera: from camera space (+X right, +Y up, looks along -Z, metres) to world. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_camera: [f64; 16],
    /// Pose to show the toy in.
    pub animation: PoseRecord,
    /// Path of the photograph of the moved toy, in the session's folder. For scoring alone; it needs a `mask`.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// Path of the labels of the truth's pixels in the session's folder, an RGBA picture of 8 bit: R is 255 where the
    /// moved toy is, G where the real one is; B is 255 times one minus the smallest visibility over all lights with the
    /// moved toy, on receivers; A the same with the real one. For scoring alone; it needs a `truth`.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
}
