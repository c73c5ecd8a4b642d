//! The ghost's shape over the camera's picture.

use glam::{DMat4, DVec3};

use app_alignment::Silhouette;
use app_scene::geometry::edges::Faces;
use app_scene::scene::{Camera, Pose};
use app_scene::toy::{PosedMesh, Toy};

/// Maximum size of a silhouette along the picture's longer side, in pixels: it is drawn again for
/// each picture.
const MOST_PX: u32 = 640;

/// A toy as authored, prepared for its silhouette.
#[derive(Clone, Debug, Default)]
pub(super) struct GhostShape {
    /// Points in object space.
    points: Vec<DVec3>,
    faces: Faces,
}

impl GhostShape {
    /// The shape of a toy; empty if the toy cannot be posed.
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

    /// The silhouette in a camera's picture of that size; `None` if it is out of the picture.
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
