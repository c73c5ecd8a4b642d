//! The shape of a toy's ghost over the camera's picture.

use glam::{DMat4, DVec3};

use app_alignment::Silhouette;
use app_scene::geometry::edges::Faces;
use app_scene::scene::{Camera, Pose};
use app_scene::toy::{PosedMesh, Toy};

/// Pixels of a silhouette along the picture's longer side, at most: it is drawn anew for each picture.
const MOST_PX: u32 = 640;

/// A toy as authored, as its silhouette needs it.
#[derive(Clone, Debug, Default)]
pub(super) struct GhostShape {
    /// In object space.
    points: Vec<DVec3>,
    faces: Faces,
}

impl GhostShape {
    /// Of a toy that can be posed; of none otherwise, and there is no silhouette.
    pub(super) fn of(toy: &Toy) -> Self {
        let mut posed = PosedMesh::default();
        if toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).is_err() {
            return Self::default();
        }
        let shadow = toy.shadow_indices();
        Self {
            points: posed.points().collect(),
            faces: Faces::new(shadow.facing_anywhere().collect()),
        }
    }

    /// What it covers of a camera's picture of that size; none where it is not in it.
    pub(super) fn silhouette(
        &self,
        world_from_object: &DMat4,
        (camera, size_px): (&Camera, [u32; 2]),
    ) -> Option<Silhouette> {
        let camera_from_object = camera.world_from_camera.inverse() * *world_from_object;
        let points = self
            .points
            .iter()
            .map(|point| camera_from_object.transform_point3(*point));
        Silhouette::of(points, &self.faces, (&camera.intrinsics, size_px), MOST_PX)
    }
}
