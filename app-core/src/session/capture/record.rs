//! The records of `capture.json`; their values are checked afterwards.

use serde::Deserialize;

/// Format and version, which decide whether the rest can be read at all.
#[derive(Deserialize)]
pub(super) struct Header {
    pub(super) format: String,
    pub(super) version: u64,
}

#[derive(Deserialize)]
pub(super) struct CaptureRecord {
    pub(super) name: String,
    pub(super) width: u32,
    pub(super) height: u32,
    #[serde(rename = "encoding")]
    _encoding: Encoding,
    pub(super) intrinsics: IntrinsicsRecord,
    pub(super) toy: ToyRecord,
    pub(super) receivers: Vec<ReceiverRecord>,
    #[serde(default)]
    pub(super) lights: Vec<LightRecord>,
    #[serde(default)]
    pub(super) backgrounds: Vec<BackgroundRecord>,
    pub(super) frames: Vec<FrameRecord>,
    pub(super) probe: Option<ProbeRecord>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Encoding {
    Srgb,
}

#[derive(Deserialize)]
pub(super) struct IntrinsicsRecord {
    pub(super) fx: f64,
    pub(super) fy: f64,
    pub(super) cx: f64,
    pub(super) cy: f64,
}

#[derive(Deserialize)]
pub(super) struct ToyRecord {
    pub(super) file: String,
    pub(super) world_from_object: [f64; 16],
    pub(super) physical_pose: PoseRecord,
}

#[derive(Deserialize)]
pub(super) struct PoseRecord {
    pub(super) clip: Option<String>,
    pub(super) time: f64,
}

#[derive(Deserialize)]
pub(super) struct ReceiverRecord {
    pub(super) name: String,
    pub(super) world_from_plane: [f64; 16],
    pub(super) half_extent: [f64; 2],
    pub(super) surface: SurfaceRecord,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SurfaceRecord {
    Uniform,
    Textured,
}

/// All kinds of light in one record: an enum tagged by `kind` would lose the path of a bad field.
#[derive(Deserialize)]
pub(super) struct LightRecord {
    pub(super) kind: LightKind,
    pub(super) position: Option<[f64; 3]>,
    pub(super) radius: Option<f64>,
    pub(super) direction_to_light: Option<[f64; 3]>,
    pub(super) angular_radius_deg: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum LightKind {
    Sphere,
    Directional,
}

#[derive(Deserialize)]
pub(super) struct BackgroundRecord {
    pub(super) image: String,
    /// Those of the session where there are none.
    pub(super) intrinsics: Option<IntrinsicsRecord>,
    pub(super) world_from_camera: [f64; 16],
}

#[derive(Deserialize)]
pub(super) struct FrameRecord {
    pub(super) time: f64,
    pub(super) image: String,
    /// Those of the session where there are none.
    pub(super) intrinsics: Option<IntrinsicsRecord>,
    /// Transform of the toy, if it was moved since the session began.
    pub(super) world_from_object: Option<[f64; 16]>,
    /// Exposure of the picture, relative to that of the other frames.
    pub(super) exposure: Option<f64>,
    pub(super) world_from_camera: [f64; 16],
    pub(super) animation: PoseRecord,
    pub(super) truth: Option<String>,
    pub(super) mask: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct ProbeRecord {
    #[serde(rename = "kind")]
    _kind: ProbeKind,
    pub(super) world_from_lens: [f64; 16],
    pub(super) radius: f64,
    pub(super) image: String,
    pub(super) exposure_ratio: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum ProbeKind {
    FresnelLens,
}
