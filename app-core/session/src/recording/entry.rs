//! A frame of a live camera as a record of the session's index.

use glam::DMat4;

use super::maps::Maps;
use crate::record::{FrameRecord, PoseRecord};
use app_scene::camera_frame::CameraImage;
use app_scene::depth::Depth;
use app_scene::people::People;
use app_scene::scene::{Camera, LightEstimate, Pose};
use app_scene::toy::Toy;

/// A live camera frame to record; the writing thread encodes its picture.
#[derive(Clone, Debug)]
pub struct LiveFrame {
    /// The camera's picture.
    pub image: CameraImage,
    /// The camera of the picture.
    pub camera: Camera,
    /// Pose of the real toy, from object space to world.
    pub world_from_object: DMat4,
    /// Exposure of the picture over that of the plates.
    pub exposure: f64,
    /// The platform's light estimate.
    pub light_estimate: Option<LightEstimate>,
    /// Depths of the picture, if a sensor measured them.
    pub depth: Option<Depth>,
    /// The mask of the people in the picture, if the platform has one.
    pub people: Option<People>,
    /// The shown pose.
    pub shown_pose: Pose,
    /// Its place, if it differs from the real toy's.
    pub world_from_shown: Option<DMat4>,
}

/// Paths of a frame's files, relative to the session.
#[derive(Clone, Debug, Default)]
pub(super) struct LivePaths {
    pub(super) picture: String,
    pub(super) maps: Maps<String>,
}

impl LiveFrame {
    /// Size of its pictures in memory.
    pub(super) fn n_bytes(&self) -> u64 {
        let depths = self.depth.as_ref().map_or(&[][..], Depth::depths_mm);
        let people = self.people.as_ref().map_or(&[][..], People::codes);
        (self.image.n_bytes() + size_of_val(depths) + people.len()) as u64
    }

    /// Its entry in the index's `frames`: taken `time_secs` after the first, with its picture and
    /// its maps at these paths.
    pub(super) fn entry(&self, time_secs: f64, paths: &LivePaths, toy: &Toy) -> FrameRecord {
        FrameRecord {
            time: time_secs,
            image: paths.picture.clone(),
            depth: paths.maps.depth.clone(),
            people: paths.maps.people.clone(),
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
