//! The records of `capture.json`; their values are checked afterwards.
//!
//! What stands at a field describes it in the format's schema, too: type and unit, space, convention. Matrices are
//! `a_from_b`, column-major. A range is that of the check.

use serde::Deserialize;

#[cfg(feature = "schema")]
use {
    super::rules::{Within, needs_of_its_kind},
    app_scene::lens,
    app_scene::scene::{MAX_FACETS, MAX_FURTHER_PICTURES, MAX_SCENE_PLATES, check},
    schemars::JsonSchema,
};

/// What `format` has to say.
pub(super) const FORMAT: &str = "shadow-capture";
/// The one version that is read.
pub(super) const VERSION: u64 = 1;

/// Format and version, which decide whether the rest can be read at all.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct Header {
    /// Name of the format. Any other is refused.
    #[cfg_attr(feature = "schema", schemars(extend("const" = FORMAT)))]
    pub(super) format: String,
    /// Version of the format. Any other is refused.
    #[cfg_attr(feature = "schema", schemars(extend("const" = VERSION)))]
    pub(super) version: u64,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct CaptureRecord {
    /// Name for people; may be empty.
    pub(super) name: String,
    /// Columns of every picture of the session, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SIDE_PX)))]
    pub(super) width: u32,
    /// Rows of every picture of the session, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SIDE_PX)))]
    pub(super) height: u32,
    /// Transfer function of all photographs.
    #[serde(rename = "encoding")]
    _encoding: Encoding,
    /// Projection of every camera that has none of its own. A pinhole without distortion: the point (x, y, z) of camera
    /// space is seen at u = cx + fx x / -z, v = cy - fy y / -z. Where a lens is given, it moves that place.
    pub(super) intrinsics: IntrinsicsRecord,
    /// Distortion of all photographs, each about its own principal point; a pinhole where there is none.
    pub(super) lens: Option<LensRecord>,
    /// The toy: its model, where it really stands and in which pose.
    pub(super) toy: ToyRecord,
    /// Planes that catch the shadow, in any order.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) receivers: Vec<ReceiverRecord>,
    /// Lights whose shadows are moved, in any order. Without any, alignment looks for them, or frames pass through.
    #[serde(default)]
    pub(super) lights: Vec<LightRecord>,
    /// Plates: photographs of the place before the toy was put there, in any order. What none shows is estimated, or
    /// stays as photographed.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_SCENE_PLATES)))]
    pub(super) backgrounds: Vec<BackgroundRecord>,
    /// Camera frames, in the order they are shown.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) frames: Vec<FrameRecord>,
    /// A light probe that lay in the scene: it tells the lights where none is listed.
    pub(super) probe: Option<ProbeRecord>,
    /// How far camera, toy and lights may be off, at most: alignment moves nothing farther than that.
    pub(super) uncertainty: Option<UncertaintyRecord>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
enum Encoding {
    /// sRGB codes (IEC 61966-2-1) of 8 bit.
    Srgb,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct IntrinsicsRecord {
    /// Focal length along the picture's rows, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::FOCAL_PX)))]
    pub(super) fx: f64,
    /// Focal length along the picture's columns, pixels.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::FOCAL_PX)))]
    pub(super) fy: f64,
    /// Principal point, pixels to the right of the picture's left border.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::POSITION_PX)))]
    pub(super) cx: f64,
    /// Principal point, pixels below the picture's top border.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::POSITION_PX)))]
    pub(super) cy: f64,
}

/// Radial distortion. With x = (u - cx) / fx, y = (v - cy) / fy and r2 = x x + y y, what a pinhole sees at (x, y) is in the
/// photograph at (1 + k1 r2 + k2 r2 r2) (x, y).
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct LensRecord {
    /// Coefficient of r2: below 0 a barrel, above it a cushion.
    #[cfg_attr(feature = "schema", schemars(transform = Within(lens::COEFFICIENT)))]
    pub(super) k1: f64,
    /// Coefficient of r2 r2; 0 where there is none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(lens::COEFFICIENT)))]
    pub(super) k2: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct ToyRecord {
    /// Path of the model, binary glTF 2.0, in the session's folder.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) file: String,
    /// Where the real toy stands: from the model's scene space, in whatever unit, to world, metres. A rotation, a
    /// translation and one positive scale.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_object: [f64; 16],
    /// Pose of the real toy, the same in all frames.
    pub(super) physical_pose: PoseRecord,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct PoseRecord {
    /// Animation of the model: its name, or `#N` for the N-th of the file, counted from 0; a name wins. Without one, or
    /// with null, nodes stand as authored.
    pub(super) clip: Option<String>,
    /// Moment of the clip, seconds from its begin. Beyond its end the last moment is shown, with a warning. Needed
    /// without a clip, too, and then of no effect.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::CLIP_TIME_SECS)))]
    pub(super) time: f64,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct ReceiverRecord {
    /// Name for people; may be empty.
    pub(super) name: String,
    /// From the receiver's plane space, metres, to world. Rigid. Local y = 0 is the plane, local +Y its normal, on the
    /// side that is lit and seen.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_plane: [f64; 16],
    /// The rectangle is |x| <= first number, |z| <= second number, metres in plane space.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    pub(super) half_extent: [f64; 2],
    /// How the receiver looks.
    pub(super) surface: SurfaceRecord,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub(super) enum SurfaceRecord {
    /// One colour all over.
    Uniform,
    /// Its colour varies.
    Textured,
}

/// All kinds of light in one record: an enum tagged by `kind` would lose the path of a bad field.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[cfg_attr(feature = "schema", schemars(description = "A light.", transform = needs_of_its_kind))]
pub(super) struct LightRecord {
    /// What the light is, which decides which other keys are needed; those of another kind are not used.
    pub(super) kind: LightKind,
    /// Centre of a sphere, metres in world space.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::LIGHT_M)))]
    pub(super) position: Option<[f64; 3]>,
    /// Radius of a sphere, metres. Zero is a point.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::RADIUS_M)))]
    pub(super) radius: Option<f64>,
    /// From the scene towards a directional light, in world space; of any length but zero.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) direction_to_light: Option<[f64; 3]>,
    /// Half the angle that a directional light's disc fills, degrees. The sun's is 0.27.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::ANGULAR_RADIUS_DEG)))]
    pub(super) angular_radius_deg: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub(super) enum LightKind {
    /// A bulb; needs `position` and `radius`.
    Sphere,
    /// A light too far away for its distance to matter; needs `direction_to_light` and `angular_radius_deg`.
    Directional,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct BackgroundRecord {
    /// Path of the photograph in the session's folder, PNG or JPEG of the session's size. Plates that name one file
    /// share it.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) image: String,
    /// Projection of the camera that took it; that of the session where there is none.
    pub(super) intrinsics: Option<IntrinsicsRecord>,
    /// Pose of the camera that took it: from camera space (+X right, +Y up, looks along -Z, metres) to world. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_camera: [f64; 16],
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct FrameRecord {
    /// When the frame was taken, seconds from an origin of the session's own.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::TIME_SECS)))]
    pub(super) time: f64,
    /// Path of the camera's picture of the real toy in the session's folder, PNG or JPEG of the session's size. Frames
    /// may repeat a picture.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) image: String,
    /// Projection of the camera in this frame; that of the session where there is none.
    pub(super) intrinsics: Option<IntrinsicsRecord>,
    /// As the toy's, in this frame: for a toy that is moved during the session. That of the toy where there is none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_object: Option<[f64; 16]>,
    /// Exposure (duration times sensitivity) of the picture over that of the session's other frames; 1 where there is
    /// none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE)))]
    pub(super) exposure: Option<f64>,
    /// What the platform estimated of the light in this frame.
    pub(super) light_estimate: Option<LightEstimateRecord>,
    /// Pose of the camera: from camera space (+X right, +Y up, looks along -Z, metres) to world. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_camera: [f64; 16],
    /// Pose to show the toy in.
    pub(super) animation: PoseRecord,
    /// Path of the photograph of the moved toy, in the session's folder. For scoring alone; it needs a `mask`.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) truth: Option<String>,
    /// Path of the labels of the truth's pixels in the session's folder, an RGBA picture of 8 bit: R is 255 where the
    /// moved toy is, G where the real one is; B is 255 times one minus the smallest visibility over all lights with the
    /// moved toy, A the same with the real one. For scoring alone; it needs a `truth`.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) mask: Option<String>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct LightEstimateRecord {
    /// From the scene towards the main light, in world space; of any length but zero.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) direction_to_light: Option<[f64; 3]>,
    /// Intensity of the main light: red, green and blue, linear, relative to the exposure.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::INTENSITY)))]
    pub(super) intensity: Option<[f64; 3]>,
    /// Intensity of the surroundings in the platform's own unit.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::INTENSITY)))]
    pub(super) ambient_intensity: Option<f64>,
    /// Colour temperature of the surroundings, kelvin.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::KELVIN)))]
    pub(super) color_temperature: Option<f64>,
    /// Radiance from all around in world space: red, green and blue of each of nine coefficients, linear, relative to the
    /// exposure. Their (degree, order) are (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) to (2, 2), real and without the
    /// Condon-Shortley phase: those of degree 1 go with y, z and x.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::HARMONIC)))]
    pub(super) spherical_harmonics: Option<[f64; 27]>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct UncertaintyRecord {
    /// Of the toy's place in each frame.
    pub(super) toy: Option<PoseUncertaintyRecord>,
    /// Of the camera of each frame and plate, but for the first plate's, which is held.
    pub(super) camera: Option<PoseUncertaintyRecord>,
    /// Of each light that is listed.
    pub(super) lights: Option<LightUncertaintyRecord>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct PoseUncertaintyRecord {
    /// How far the middle of the toy, or the camera, may be elsewhere, metres. Zero where it is known.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_M)))]
    pub(super) position: Option<f64>,
    /// How far it may be turned, about whatever axis, degrees. Zero where that is known.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_DEG)))]
    pub(super) rotation_deg: Option<f64>,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct LightUncertaintyRecord {
    /// How far its direction, as seen from the toy, may be off, degrees. Zero where it is known.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_DEG)))]
    pub(super) direction_deg: Option<f64>,
    /// Largest ratio of true distance and given one, or the other way round. One where it is known.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_RATIO)))]
    pub(super) distance_ratio: Option<f64>,
    /// The same of the size as seen from the toy. One where it is known.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::UNCERTAINTY_RATIO)))]
    pub(super) size_ratio: Option<f64>,
}

/// All kinds of probe in one record.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct ProbeRecord {
    /// What the probe is.
    pub(super) kind: ProbeKind,
    /// From the probe's space, metres, to world. Rigid. A lens is a disc around the origin in local y = 0, its normal
    /// local +Y; a ball is around the origin.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_lens: [f64; 16],
    /// Radius of disc or ball, metres.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    pub(super) radius: f64,
    /// Focal length of a lens whose facets spread light as a convex mirror does, metres. Without one, or with null, its
    /// facets are the hemisphere's.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXTENT_M)))]
    pub(super) focal_length: Option<f64>,
    /// Slopes of a lens's facets as calibrated, from the axis outwards; they come before a focal length. Without any
    /// that holds, or the hemisphere.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_FACETS)))]
    pub(super) facets: Vec<FacetRecord>,
    /// Path of a picture of it in the session's folder, PNG or JPEG of the session's size, underexposed.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) image: String,
    /// Exposure of that picture over that of a frame.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE_RATIO)))]
    pub(super) exposure_ratio: f64,
    /// Projection of the camera that took it; that of the first frame where there is none.
    pub(super) intrinsics: Option<IntrinsicsRecord>,
    /// Pose of the camera that took it; that of the first frame where there is none. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_camera: Option<[f64; 16]>,
    /// Further pictures, in the order that they were taken: several views tell how far away a light is.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(length(max = MAX_FURTHER_PICTURES)))]
    pub(super) pictures: Vec<ProbePictureRecord>,
}

#[derive(Clone, Copy, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
pub(super) enum ProbeKind {
    /// A flat reflective Fresnel lens, a mirror ball pressed flat: at disc position (x, z) / radius its normal is that of
    /// the hemisphere above that point, unless `facets` or `focal_length` say otherwise.
    FresnelLens,
    /// A ball that mirrors.
    MirrorBall,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct FacetRecord {
    /// Distance from the axis over the lens's radius; above that of the entry before.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::OF_RADIUS)))]
    pub(super) at: f64,
    /// Angle between the facet's normal, which leans outwards, and the lens's, degrees.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::SLOPE_DEG)))]
    pub(super) slope_deg: f64,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema))]
pub(super) struct ProbePictureRecord {
    /// Path of the picture in the session's folder, PNG or JPEG of the session's size, underexposed.
    #[cfg_attr(feature = "schema", schemars(length(min = 1)))]
    pub(super) image: String,
    /// Exposure of the picture over that of a frame; as of the probe's `image` where there is none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::EXPOSURE_RATIO)))]
    pub(super) exposure_ratio: Option<f64>,
    /// Projection of the camera that took it; that of the session where there is none.
    pub(super) intrinsics: Option<IntrinsicsRecord>,
    /// Pose of the camera that took it. Rigid.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_camera: [f64; 16],
    /// Where the probe was then; as in its `image` where there is none.
    #[cfg_attr(feature = "schema", schemars(transform = Within(check::COORDINATE_M)))]
    pub(super) world_from_lens: Option<[f64; 16]>,
}
