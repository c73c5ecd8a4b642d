//! The records of `capture.json`: the format's only definition, which all readers and writers use.
//! Only the reader checks the values.
//!
//! The comments on fields become descriptions in the format's schema: type and unit, space,
//! convention. Matrices are `a_from_b`, column-major. A range is the one that the reader checks.

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

/// Value of `format`.
pub(super) const FORMAT: &str = "shadow-capture";
/// The only supported version.
pub(super) const VERSION: u64 = 1;

/// `capture.json` of a `shadow-capture` folder, version 1. World space is right-handed, +Y up, metres. A matrix `a_from_b`
/// takes points of b to a; its 16 numbers are column-major. The centre of the first pixel is at (0.5, 0.5).
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(title = "shadow-capture"))]
pub struct Index {
    /// Format and version.
    #[serde(flatten)]
    pub header: Header,
    /// The part that is read.
    #[serde(flatten)]
    pub capture: CaptureRecord,
    /// The part that is not read.
    #[serde(flatten)]
    pub remarks: Remarks,
}

impl From<CaptureRecord> for Index {
    /// An index without remarks.
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
    /// Description of the scene, for people. Not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Authors and licences of toy and pictures. Not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub credits: Option<String>,
    /// Unit of all lengths, which is the metre whatever stands here. Not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub units: Option<String>,
}

/// Format and version, which decide whether the rest can be read.
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
    /// The supported format and version.
    fn default() -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
        }
    }
}

/// All of the index that is read, without format and version.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct CaptureRecord {
    /// Name for people, or empty.
    pub name: String,
    /// Columns of every picture of the session, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SIDE_PX)))]
    pub width: u32,
    /// Rows of every picture of the session, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SIDE_PX)))]
    pub height: u32,
    /// Transfer function of all photographs.
    pub encoding: Encoding,
    /// Projection of every camera without its own. A pinhole without distortion: the point (x, y,
    /// z) of camera space is seen at u = cx + fx x / -z, v = cy - fy y / -z. If there is a lens, it
    /// moves that place.
    pub intrinsics: IntrinsicsRecord,
    /// Distortion of all photographs, each about its own principal point; none by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens: Option<LensRecord>,
    /// The toy: its model, and the real toy's place and pose.
    pub toy: ToyRecord,
    /// Planes that catch the shadow, in any order; shadows are retargeted on the four nearest to
    /// the toy.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub receivers: Vec<ReceiverRecord>,
    /// Lights whose shadows are retargeted, in any order; those beyond the fourth are ignored, with
    /// a warning. If the list is empty, lights are estimated from the probe, or by alignment from
    /// the toy's shadow; if none is found, the toy moves in ambient light, with a warning.
    #[serde(default)]
    pub lights: Vec<LightRecord>,
    /// Plates: photographs of the place without the toy, in any order. A part that none shows is
    /// estimated, or stays as photographed; without plates, the place is estimated, or frames pass
    /// through (presets `paper` and `flat`).
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_SCENE_PLATES)))]
    pub backgrounds: Vec<BackgroundRecord>,
    /// Camera frames, in the order of presentation.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub frames: Vec<FrameRecord>,
    /// A light probe in the scene: lights are estimated from it if none is listed, and alignment
    /// corrects them by the toy's shadow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probe: Option<ProbeRecord>,
    /// A measured mesh of the place: planes of things are searched close to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place_mesh: Option<PlaceMeshRecord>,
    /// Largest errors of camera, toy and lights: alignment changes nothing by more. Not bounded by
    /// default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<UncertaintyRecord>,
}

/// Encoding of light in photographs.
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
    /// Coefficient of r2: negative for a barrel, positive for a pincushion.
    #[cfg_attr(feature = "schema", schemars(transform = Within(lens::COEFFICIENT)))]
    pub k1: f64,
    /// Coefficient of r2 r2; 0 by default.
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
    /// Pose of the real toy: from the model's scene space, in any unit, to world, metres. A
    /// rotation, a translation and one scale for all axes, from 1e-6 to 1e6, for example 0.001 for
    /// a model in millimetres.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_object: [f64; 16],
    /// Pose of the real toy's shape, the same in all frames.
    pub physical_pose: PoseRecord,
    /// Whether the toy rests on the receiver below it: true keeps it there during alignment, false
    /// lets it float. By default, a toy close to a receiver rests there unless the picture
    /// contradicts it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resting: Option<bool>,
}

/// A pose of the toy; by default nodes stay as authored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct PoseRecord {
    /// Animation of the model: its name, or `#N` for the N-th of the file, counted from 0. A name
    /// has priority, and an unknown one is refused. Without one, or with null, nodes stay as
    /// authored.
    pub clip: Option<String>,
    /// Moment of the clip, seconds from its start. Beyond its end the last moment is shown, with a
    /// warning. Required without a clip, too, and then without effect.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::CLIP_TIME_SECS)))]
    pub time: f64,
}

/// A rectangle that catches the shadow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct ReceiverRecord {
    /// Name for people, or empty.
    pub name: String,
    /// From the receiver's plane space, metres, to world. Rigid. Local y = 0 is the plane, local +Y
    /// its normal, on the lit and visible side.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_plane: [f64; 16],
    /// Half the rectangle's sides along local x and z, around the plane's origin, metres.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    pub half_extent: [f64; 2],
    /// Appearance of the receiver.
    pub surface: SurfaceRecord,
}

/// A mesh of the place as a scanner measured it, with or without the toy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct PlaceMeshRecord {
    /// Path of the mesh, glTF 2.0, in the session's folder. Its scene space is the world, metres. Its materials are not
    /// used.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub file: String,
    /// Standard deviation of its points, metres; unknown by default. The smaller it is, the closer
    /// planes stay to the mesh.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation: Option<f64>,
}

/// Appearance of a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SurfaceRecord {
    /// Uniform colour.
    Uniform,
    /// Varying colour.
    Textured,
}

/// All kinds of light in one record: an enum tagged by `kind` would lose the path of a bad field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(description = "A light.", transform = needs_of_its_kind))]
pub struct LightRecord {
    /// Kind of the light, which decides which other keys are required; keys of other kinds are
    /// ignored, but must have their type.
    pub kind: LightKind,
    /// Centre of a sphere, metres in world space.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::LIGHT_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f64; 3]>,
    /// Radius of a sphere, metres. Zero for a point.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::RADIUS_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// From the scene towards a directional light, in world space; of any length of 1e-9 or more.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction_to_light: Option<[f64; 3]>,
    /// Angular radius of a directional light, degrees. The sun's is 0.27.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::ANGULAR_RADIUS_DEG)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_radius_deg: Option<f64>,
}

/// Kind of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// A bulb; requires `position` and `radius`.
    #[default]
    Sphere,
    /// A light at infinity; requires `direction_to_light` and `angular_radius_deg`.
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
    /// Projection of its camera; the session's by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<IntrinsicsRecord>,
    /// Pose of its camera: from camera space (+X right, +Y up, looks along -Z, metres) to world.
    /// Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_camera: [f64; 16],
}

/// A camera frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub struct FrameRecord {
    /// Time of the frame, seconds from an origin of the session's own.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::TIME_SECS)))]
    pub time: f64,
    /// Path of the camera's picture of the real toy in the session's folder, PNG or JPEG of the session's size. Frames
    /// may repeat a picture.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub image: String,
    /// Projection of the camera in this frame, for example of one that focuses; the session's by
    /// default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<IntrinsicsRecord>,
    /// Pose of the real toy in this frame, by the rules of the toy's own, for a toy that is moved
    /// during the session. The toy's own by default.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_object: Option<[f64; 16]>,
    /// Place to show the toy in this frame, by the rules of the toy's own `world_from_object`; the
    /// real toy's by default. It is a place in the world: a correction of the real toy's pose does
    /// not move it.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_shown: Option<[f64; 16]>,
    /// Exposure (duration times sensitivity) of the picture over that of the session's other
    /// frames; 1 by default.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
    /// The platform's light estimate in this frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_estimate: Option<LightEstimateRecord>,
    /// Path of the frame's depths in the session's folder: a grey PNG of 16 bit that shows what `image` shows, without
    /// a lens's distortion, in a size of its own. A pixel is the distance along the view in millimetres, or 0 if it is
    /// unknown.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<String>,
    /// Path of a mask of the people in the frame's picture, in the session's folder: a grey PNG of 8 bit that shows
    /// what `image` shows, without a lens's distortion, in a size of its own. A pixel is 255 on a person, and 0
    /// elsewhere.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub people: Option<String>,
    /// Pose of the camera: from camera space (+X right, +Y up, looks along -Z, metres) to world. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub world_from_camera: [f64; 16],
    /// Pose to show.
    pub animation: PoseRecord,
    /// Path of the photograph of the moved toy, in the session's folder. Only for scoring; it
    /// requires a `mask`.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// Path of the labels of the truth's pixels in the session's folder, an RGBA picture of 8 bit:
    /// R is 255 on the moved toy, G on the real one; B is 255 times one minus the smallest
    /// visibility over all lights with the moved toy, on receivers; A the same with the real one.
    /// Only for scoring; it requires a `truth`.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
}
