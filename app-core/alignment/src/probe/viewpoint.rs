//! Lines of sight.

use glam::{DMat4, DVec2, DVec3};

use app_scene::scene::{Camera, Intrinsics};

/// A camera in a probe's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewpoint {
    intrinsics: Intrinsics,
    probe_from_camera: DMat4,
    camera_from_probe: DMat4,
}

impl Viewpoint {
    pub(super) fn new(camera: &Camera, world_from_probe: &DMat4) -> Self {
        let probe_from_camera = world_from_probe.inverse() * camera.world_from_camera;
        Self {
            intrinsics: camera.intrinsics,
            probe_from_camera,
            camera_from_probe: probe_from_camera.inverse(),
        }
    }

    /// The camera's centre.
    pub(super) fn place(&self) -> DVec3 {
        self.probe_from_camera.w_axis.truncate()
    }

    /// Unit vector along the line of sight through a pixel.
    pub(super) fn sight(&self, at_px: DVec2) -> DVec3 {
        let ray = self.intrinsics.ray(at_px);
        self.probe_from_camera.transform_vector3(ray).normalize()
    }

    /// The image of a point, in pixels; `None` behind the camera.
    pub(super) fn pixel(&self, point: DVec3) -> Option<DVec2> {
        self.intrinsics
            .pixel_of(self.camera_from_probe.transform_point3(point))
    }
}
