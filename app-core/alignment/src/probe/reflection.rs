//! The law of reflection.

use glam::{DMat4, DVec3};

/// A reflected line of sight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection {
    /// Point of reflection.
    pub(super) at: DVec3,
    /// Unit vector from there.
    pub(super) toward: DVec3,
}

impl Reflection {
    /// `None` if the viewer is behind the normal's face.
    pub(super) fn of(at: DVec3, normal: DVec3, viewer: DVec3) -> Option<Self> {
        let cosine = normal.dot(viewer);
        (cosine > 0.0).then(|| Self {
            at,
            toward: (2.0 * cosine * normal - viewer).normalize(),
        })
    }

    pub(super) fn in_world(&self, world_from_probe: &DMat4) -> Self {
        Self {
            at: world_from_probe.transform_point3(self.at),
            toward: world_from_probe.transform_vector3(self.toward).normalize(),
        }
    }
}
