//! Distances between the image positions of points seen by two cameras, or in two poses.

use glam::{DMat4, DVec3};

use crate::geometry::view::{NEAR_M, View};

/// Below this distance two cameras count as the same: at the sharpest edge, of 200 codes a pixel, two codes.
const SAME_VIEW_PX: f64 = 0.01;

/// Whether two cameras project `points_in_world`, and points between them, to the same pixels.
pub(crate) fn is_same_view(views: [&View; 2], points_in_world: &[DVec3]) -> bool {
    views[0] == views[1] || between_views(views, points_in_world) < SAME_VIEW_PX
}

/// Largest distance, in pixels, between where two cameras show `points_in_world`.
///
/// Points behind both cameras do not count; one behind only one of them is infinitely far.
#[must_use]
pub(crate) fn between_views(views: [&View; 2], points_in_world: &[DVec3]) -> f64 {
    let [a, b] = views.map(|view| move |p: DVec3| view.image_px_from(&DMat4::IDENTITY, p.extend(1.0)));
    let distances = points_in_world.iter().map(|p| distance_px(a(*p), b(*p)));
    distances.fold(0.0, f64::max)
}

/// Largest distance, in pixels, between where a camera shows points of an object in two poses of the whole object.
///
/// As above for points behind the camera.
#[must_use]
pub(crate) fn between_poses(
    view: &View,
    world_from_object: [&DMat4; 2],
    points_in_object: impl Iterator<Item = DVec3>,
) -> f64 {
    let [a, b] = world_from_object.map(|pose| move |p: DVec3| view.image_px_from(pose, p.extend(1.0)));
    let distances = points_in_object.map(|p| distance_px(a(p), b(p)));
    distances.fold(0.0, f64::max)
}

/// Between two homogeneous image positions, as [`View::image_px_from`] returns them.
fn distance_px(a: DVec3, b: DVec3) -> f64 {
    match (a.z > NEAR_M, b.z > NEAR_M) {
        (false, false) => 0.0,
        (true, true) => (a.truncate() / a.z).distance(b.truncate() / b.z),
        _ => f64::INFINITY,
    }
}
