//! The toy in the reference camera: the parts of it that a key's photograph shows, and the places
//! of toy and shadows.

use app_core::scene::{Camera, Light, Pose, Receiver};
use app_core::toy::{PosedMesh, Toy, ToyError};
use glam::{DMat4, DVec2, DVec3};

use super::raster::{Sights, in_front, mark};

/// Points of a light whose shadows are drawn: its centre and this number around its rim.
const N_RIM: u32 = 8;
/// A surface is hidden if it is farther than the visible one by this fraction of the toy's size.
const HIDDEN_DEPTH: f64 = 0.01;
/// Weight of parts that a key does not show, so that parts that neither shows are weighted by time
/// alone.
const UNSEEN: f32 = 0.02;
/// Cosine ratio below which a surface is seen too obliquely.
const STEEP: f64 = 0.25;

/// A toy with a pose and a place, in a camera.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// Vertices in world.
    points: Vec<DVec3>,
    /// Their places in the picture: u, v in pixels, and the depth in metres.
    corners: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    sights: Sights,
    camera: View,
    size_px: [usize; 2],
}

/// A camera with the inverse of its pose.
#[derive(Clone, Copy, Debug)]
struct View {
    camera: Camera,
    camera_from_world: DMat4,
}

impl View {
    fn new(camera: &Camera) -> Self {
        Self {
            camera: *camera,
            camera_from_world: camera.world_from_camera.inverse(),
        }
    }

    /// The place of a world point in the picture: u, v in pixels, and the depth in metres.
    fn seen_at(&self, point: DVec3) -> DVec3 {
        let in_camera = self.camera_from_world.transform_point3(point);
        let at_px = self.camera.intrinsics.pixel_of(in_camera).unwrap_or(DVec2::ZERO);
        at_px.extend(-in_camera.z)
    }
}

impl Figure {
    /// Poses and draws a toy.
    ///
    /// # Errors
    /// When it cannot be posed.
    pub(super) fn new(
        toy: &Toy,
        (pose, world_from_object): (&Pose, &DMat4),
        camera: &Camera,
        size_px: [usize; 2],
    ) -> Result<Self, ToyError> {
        let mut posed = PosedMesh::default();
        toy.pose(pose, world_from_object, &mut posed)?;
        let camera = View::new(camera);
        let points: Vec<DVec3> = posed.points().collect();
        let corners: Vec<DVec3> = points.iter().map(|point| camera.seen_at(*point)).collect();
        let (triangles, _) = toy.indices().as_chunks::<3>();
        Ok(Self {
            sights: Sights::draw(&corners, triangles, size_px),
            points,
            corners,
            triangles: triangles.to_vec(),
            camera,
            size_px,
        })
    }

    /// Pixels of the toy.
    #[must_use]
    pub(super) fn covered(&self) -> Vec<bool> {
        let mut mask = vec![false; self.size_px[0] * self.size_px[1]];
        self.draw(&self.corners, &mut mask);
        mask
    }

    /// Pixels of the toy and of all its shadows on receivers.
    #[must_use]
    pub(super) fn touched(&self, receivers: &[Receiver], lights: &[Light]) -> Vec<bool> {
        let mut mask = self.covered();
        for light in lights {
            for receiver in receivers {
                for point in points_of(light, self.middle()) {
                    self.draw(&self.shadow(receiver, light, point), &mut mask);
                }
            }
        }
        mask
    }

    /// Vertices in world.
    #[must_use]
    pub(super) fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The mean of the vertices.
    #[must_use]
    pub(super) fn middle(&self) -> DVec3 {
        let (least, most) = self.bounds();
        0.5 * (least + most)
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let bounds = |(least, most): (DVec3, DVec3), point: &DVec3| (least.min(*point), most.max(*point));
        self.points.iter().fold(start, bounds)
    }

    fn draw(&self, corners: &[DVec3], mask: &mut [bool]) {
        for triangle in &self.triangles {
            if let Some(corners) = in_front(corners, *triangle) {
                mark(mask, self.size_px, corners.map(DVec3::truncate));
            }
        }
    }

    /// Vertices projected on a receiver from a point of a light, as the camera sees them; of depth
    /// 0 if there is no shadow.
    fn shadow(&self, receiver: &Receiver, light: &Light, source: DVec3) -> Vec<DVec3> {
        let plane_from_world = receiver.world_from_plane.inverse();
        let cast = |point: &DVec3| {
            let away = match light {
                Light::Directional { .. } => -source,
                Light::Sphere { .. } => *point - source,
            };
            let (at, step) = (
                plane_from_world.transform_point3(*point),
                plane_from_world.transform_vector3(away),
            );
            let steps = -at.y / step.y;
            let hit = at + steps * step;
            let is_on = steps.is_finite()
                && steps >= 0.0
                && DVec2::new(hit.x, hit.z).abs().cmple(receiver.half_extent_m).all();
            is_on.then(|| {
                self.camera
                    .seen_at(receiver.world_from_plane.transform_point3(hit))
            })
        };
        self.points
            .iter()
            .map(|point| cast(point).unwrap_or(DVec3::ZERO))
            .collect()
    }

    /// The visibility of each pixel of this figure in another one of the same toy, 0 to 1; `None`
    /// for pixels beside the toy.
    #[must_use]
    pub(super) fn seen_in(&self, other: &Self) -> Vec<Option<f32>> {
        let (least, most) = self.bounds();
        let hidden_m = HIDDEN_DEPTH * (most - least).length();
        let pixels = 0..self.size_px[0] * self.size_px[1];
        pixels.map(|pixel| self.seen_at(pixel, other, hidden_m)).collect()
    }

    fn seen_at(&self, pixel: usize, other: &Self, hidden_m: f64) -> Option<f32> {
        let sight = self.sights.at(pixel)?;
        let triangle = *self.triangles.get(sight.triangle as usize)?;
        let [a, b, c] = triangle.map(|corner| other.points.get(corner as usize).copied());
        let corners = [a?, b?, c?];
        let weights = sight.corners.map(f64::from);
        let point = (0..3).map(|k| weights[k] * corners[k]).sum::<DVec3>();
        let there = other.camera.seen_at(point);
        let farthest_m = other.sights.farthest_m(there.truncate());
        let is_hidden = farthest_m.is_none_or(|farthest_m| there.z > f64::from(farthest_m) + hidden_m);
        let cosine = other.cosine(triangle);
        if is_hidden || cosine <= 0.0 {
            return Some(0.0);
        }
        // Seen more obliquely than shown, a surface has fewer pixels than needed.
        let ratio = cosine / self.cosine(triangle).max(STEEP);
        #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
        let seen = (ratio / STEEP).clamp(0.0, 1.0) as f32;
        Some(seen)
    }

    /// Cosine between a triangle's normal and the line of sight; negative for a back face.
    fn cosine(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|corner| self.points[corner as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let eye = self.camera.camera.world_from_camera.w_axis.truncate();
        normal.dot((eye - a).normalize_or_zero())
    }
}

/// Weight of a visibility.
#[must_use]
pub(super) fn seen_weight(seen: f32) -> f32 {
    UNSEEN + (1.0 - UNSEEN) * seen
}

/// Points of a light: places, or directions to a directional one.
fn points_of(light: &Light, from: DVec3) -> Vec<DVec3> {
    let (middle, radius) = match *light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => (position_in_world, radius_m),
        Light::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        } => (
            direction_to_light_in_world.normalize_or_zero(),
            angular_radius_rad.tan(),
        ),
    };
    let axis = match light {
        Light::Sphere { .. } => (middle - from).normalize_or(DVec3::Y),
        Light::Directional { .. } => middle.normalize_or(DVec3::Y),
    };
    let (right, up) = axis.any_orthonormal_pair();
    let rim = (0..N_RIM).map(|k| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(N_RIM);
        middle + radius * (angle.cos() * right + angle.sin() * up)
    });
    std::iter::once(middle).chain(rim).collect()
}
