//! The contour of a toy's ghost over the camera's picture.

use glam::{DMat4, DVec2, DVec3};

use app_scene::geometry::edges::Faces;
use app_scene::scene::{Camera, Pose};
use app_scene::toy::{PosedMesh, Toy};

/// A toy as authored, as its contour needs it.
#[derive(Clone, Debug, Default)]
pub(super) struct GhostShape {
    /// In object space.
    points: Vec<DVec3>,
    faces: Faces,
}

impl GhostShape {
    /// Of a toy that can be posed; of none otherwise, and the contour is empty.
    pub(super) fn of(toy: &Toy) -> Self {
        let mut posed = PosedMesh::default();
        if toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).is_err() {
            return Self::default();
        }
        let shadow = toy.shadow_indices();
        let triangles = shadow.indices.as_chunks().0.to_vec();
        Self {
            points: posed.points().collect(),
            faces: Faces::new(triangles),
        }
    }

    /// Edges between a face towards the camera and one away from it, as pairs of pixels; those that others hide are among them.
    pub(super) fn contour_px(&self, world_from_object: &DMat4, camera: &Camera) -> Vec<[DVec2; 2]> {
        let camera_from_object = camera.world_from_camera.inverse() * *world_from_object;
        let seen = self
            .points
            .iter()
            .map(|point| camera_from_object.transform_point3(*point));
        let seen: Vec<DVec3> = seen.collect();
        let pixels: Vec<Option<DVec2>> = seen
            .iter()
            .map(|point| camera.intrinsics.pixel_of(*point))
            .collect();
        let faces_camera = |index: u32| {
            let [a, b, c] = self
                .faces
                .triangles
                .get(index as usize)?
                .map(|corner| seen[corner as usize]);
            Some((b - a).cross(c - a).dot(a) < 0.0)
        };
        let contour = self.faces.edges.iter().filter_map(|edge| {
            let [one, other] = edge.sides.map(faces_camera);
            (one != other).then_some(())?;
            let [from, to] = edge.corners.map(|corner| pixels[corner as usize]);
            Some([from?, to?])
        });
        contour.collect()
    }
}
