//! Points of the surfaces in a view, as a depth sensor or a mesh of the place has them.

use glam::{DMat4, DVec3, IVec2, UVec2};

use super::raster::nearest_depths;
use app_scene::depth::Depth;
use app_scene::frame::FrameInput;
use app_scene::place_mesh::PlaceMesh;
use app_scene::scene::{Intrinsics, Scene};

/// Most points that are used: more add nothing to a plane.
const MOST_POINTS: u32 = 50_000;

/// Points that a small picture shows.
#[derive(Clone, Debug)]
pub(super) struct MeasuredPoints {
    /// Size of the picture.
    pub(super) size_px: IVec2,
    /// The pixel of each point.
    pub(super) places: Vec<IVec2>,
    /// In camera space.
    pub(super) points: Vec<DVec3>,
    /// Standard deviation of a point in metres, if it is stated.
    pub(super) deviation_m: Option<f64>,
}

impl MeasuredPoints {
    /// Those of a frame: by the scene's mesh, then by the frame's depths.
    pub(super) fn of(scene: &Scene, input: &FrameInput) -> Vec<Self> {
        let size_px = UVec2::from_array(input.image.size_px());
        let k = input.camera.intrinsics;
        let camera_from_world = input.camera.world_from_camera.inverse();
        let mesh = scene.place_mesh.as_ref();
        let of_mesh = mesh.map(|mesh| Self::of_mesh(mesh, &camera_from_world, (k, size_px)));
        let depth = input.depth.as_ref();
        let of_depth = depth.map(|depth| Self::of_depth(depth, (k, size_px)));
        of_mesh.into_iter().chain(of_depth).collect()
    }

    fn of_depth(depth: &Depth, (k, picture_px): (Intrinsics, UVec2)) -> Self {
        let every = depth.depths_mm().len().div_ceil(MOST_POINTS as usize).max(1);
        let points = depth.points(k, picture_px).step_by(every);
        let (places, points) = points.unzip();
        Self {
            size_px: depth.size_px().as_ivec2(),
            places,
            points,
            deviation_m: None,
        }
    }

    /// The points that a small picture of the mesh shows.
    fn of_mesh(mesh: &PlaceMesh, camera_from_world: &DMat4, (k, picture_px): (Intrinsics, UVec2)) -> Self {
        let px = (f64::from(picture_px.element_product()) / f64::from(MOST_POINTS))
            .sqrt()
            .max(1.0);
        let size_px = (picture_px.as_dvec2() / px).floor().as_ivec2();
        let k = k.scaled(px.recip());
        let points: Vec<DVec3> = mesh
            .points()
            .iter()
            .map(|point| camera_from_world.transform_point3(point.as_dvec3()))
            .collect();
        let triangles = mesh.triangles().iter();
        let triangles = triangles.map(|corners| corners.map(|corner| points[corner as usize]));
        let seen = nearest_depths(triangles, &k, size_px);
        let (places, points) = seen
            .map(|(at, depth_m)| (at, f64::from(depth_m) * k.ray(at.as_dvec2() + 0.5)))
            .unzip();
        Self {
            size_px,
            places,
            points,
            deviation_m: mesh.deviation_m(),
        }
    }

    /// The points with a property.
    pub(super) fn filtered(&self, is_kept: impl Fn(&DVec3) -> bool) -> Self {
        let all = self.places.iter().zip(&self.points);
        let kept = all.filter(|(_, point)| is_kept(point));
        let (places, points) = kept.unzip();
        Self {
            places,
            points,
            ..*self
        }
    }
}
