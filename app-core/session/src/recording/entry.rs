//! A frame of a live camera, as the index of a session has it.

use glam::DMat4;

use crate::record::{FrameRecord, PoseRecord};
use app_scene::camera_frame::CameraImage;
use app_scene::scene::{Camera, LightEstimate, Pose};
use app_scene::toy::Toy;

/// A camera frame that is recorded as it comes; its picture is encoded by whoever writes it.
#[derive(Clone, Debug)]
pub struct LiveFrame {
    /// The camera's picture.
    pub image: CameraImage,
    /// The camera that took it.
    pub camera: Camera,
    /// Where the real toy stands, from object space to world.
    pub world_from_object: DMat4,
    /// Exposure of the picture over that of the plates.
    pub exposure: f64,
    /// What the platform estimates of the light.
    pub light_estimate: Option<LightEstimate>,
    /// The pose that was shown.
    pub shown_pose: Pose,
    /// Where it was shown, if that is not where the real toy stands.
    pub world_from_shown: Option<DMat4>,
}

impl LiveFrame {
    /// Its entry of the index's `frames`: taken `time_secs` after the first, its picture at `path`.
    pub(super) fn entry(&self, time_secs: f64, path: &str, toy: &Toy) -> FrameRecord {
        FrameRecord {
            time: time_secs,
            image: path.to_owned(),
            intrinsics: Some((&self.camera.intrinsics).into()),
            world_from_object: Some(self.world_from_object.to_cols_array()),
            world_from_shown: self.world_from_shown.map(|matrix| matrix.to_cols_array()),
            exposure: Some(self.exposure),
            light_estimate: self.light_estimate.as_ref().map(Into::into),
            world_from_camera: self.camera.world_from_camera.to_cols_array(),
            animation: PoseRecord::new(&self.shown_pose, toy),
            ..FrameRecord::default()
        }
    }
}
