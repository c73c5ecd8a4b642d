//! Distances between the image positions of points in two cameras or in two poses.

use glam::{DMat4, DVec3, DVec4};

use crate::geometry::extent::NEAR_M;
use crate::geometry::reach::shadow_of;
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;

/// Distance below which two cameras count as equal: at the sharpest edge, of 200 codes a pixel, it
/// is two codes.
const SAME_VIEW_PX: f64 = 0.01;

/// Whether two cameras project `points_in_world`, and points between them, to the same pixels.
pub(crate) fn is_same_view(views: [&View; 2], points_in_world: &[DVec3]) -> bool {
    views[0] == views[1] || between_views(views, points_in_world) < SAME_VIEW_PX
}

/// Largest distance, in pixels, between the image positions of `points_in_world` in two cameras.
///
/// Points behind both cameras do not count; a point behind one of them is infinitely far.
#[must_use]
pub(crate) fn between_views(views: [&View; 2], points_in_world: &[DVec3]) -> f64 {
    let [a, b] = views.map(|view| move |p: DVec3| view.image_px_from(&DMat4::IDENTITY, p.extend(1.0)));
    let distances = points_in_world.iter().map(|p| distance_px(a(*p), b(*p)));
    distances.fold(0.0, f64::max)
}

/// Largest distance, in pixels, between the image positions of an object's points, or of their
/// shadows, in two poses of the whole object. A shadow shows motion along the line of sight, which
/// the points themselves hardly show.
///
/// Points behind the camera are handled as above, and so are points without a shadow.
#[must_use]
pub(crate) fn between_poses(
    view: &View,
    layout: &SceneLayout<'_>,
    world_from_object: [&DMat4; 2],
    points_in_object: impl Iterator<Item = DVec3>,
) -> f64 {
    let of_point = |p: DVec3| {
        let [a, b] = world_from_object.map(|pose| images(view, layout, pose.transform_point3(p)));
        a.into_iter()
            .zip(b)
            .map(|(a, b)| distance_px(a, b))
            .fold(0.0, f64::max)
    };
    points_in_object.map(of_point).fold(0.0, f64::max)
}

/// Homogeneous image positions of a point and of its shadows from each light on each receiver; zero
/// if there is no shadow.
fn images(view: &View, layout: &SceneLayout<'_>, in_world: DVec3) -> Vec<DVec3> {
    let own = view.image_px_from(&DMat4::IDENTITY, in_world.extend(1.0));
    let shadows = layout.receivers.iter().flat_map(|receiver| {
        let plane_from_world = receiver.world_from_plane.inverse();
        let in_plane = plane_from_world.transform_point3(in_world);
        let lights = layout.lights.iter();
        lights.map(move |light| {
            let shadow = shadow_of(in_plane, light.centre_in(&plane_from_world));
            if in_plane.y < 0.0 || shadow.z <= 0.0 {
                return DVec3::ZERO;
            }
            let at = receiver.rect.nearest(shadow.truncate() / shadow.z);
            view.image_px_from(&receiver.world_from_plane, DVec4::new(at.x, 0.0, at.y, 1.0))
        })
    });
    [own].into_iter().chain(shadows).collect()
}

/// Distance between two homogeneous image positions, as [`View::image_px_from`] returns them.
fn distance_px(a: DVec3, b: DVec3) -> f64 {
    match (a.z > NEAR_M, b.z > NEAR_M) {
        (false, false) => 0.0,
        (true, true) => (a.truncate() / a.z).distance(b.truncate() / b.z),
        _ => f64::INFINITY,
    }
}
