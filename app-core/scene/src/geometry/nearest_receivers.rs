//! The order of receivers by their distance from a toy.

use std::cmp::Ordering;

use glam::{DMat4, DVec2, DVec3};

use super::bounds::Bounds;
use crate::scene::{Receiver, Scene};
use crate::toy;

/// Corners of a toy's box in a place, by which its receivers are ranked.
pub fn corners_in_world(toy_in_object: &toy::Bounds, world_from_object: &DMat4) -> Vec<DVec3> {
    let bounds = Bounds {
        min: toy_in_object.min.as_dvec3(),
        max: toy_in_object.max.as_dvec3(),
    };
    let corners = bounds.corners();
    corners
        .map(|corner| world_from_object.transform_point3(corner))
        .collect()
}

/// Indices of a scene's receivers, the one nearest to the toy in a place first.
pub fn nearest_to_toy(scene: &Scene, world_from_object: &DMat4) -> Vec<usize> {
    let points = match scene.toy.bounds_of_pose(&scene.physical_pose) {
        Ok(bounds) => corners_in_world(&bounds, world_from_object),
        // A toy that cannot be posed is refused elsewhere.
        Err(_) => vec![world_from_object.w_axis.truncate()],
    };
    nearest_receivers(&scene.receivers, &points)
}

/// Indices of receivers, the one nearest to any of `points_in_world` first. The result does not
/// depend on their order in the list.
pub fn nearest_receivers(receivers: &[Receiver], points_in_world: &[DVec3]) -> Vec<usize> {
    let ranks: Vec<Vec<f64>> = receivers
        .iter()
        .map(|receiver| rank(receiver, points_in_world))
        .collect();
    let mut indices: Vec<usize> = (0..receivers.len()).collect();
    indices.sort_by(|a, b| {
        let orders = ranks[*a].iter().zip(&ranks[*b]).map(|(a, b)| a.total_cmp(b));
        orders.fold(Ordering::Equal, Ordering::then)
    });
    indices
}

/// Sort key of a receiver: its distance in metres, and further numbers that break ties.
fn rank(receiver: &Receiver, points_in_world: &[DVec3]) -> Vec<f64> {
    let plane_from_world = receiver.world_from_plane.inverse();
    let distance_m = |point: &DVec3| {
        let at = plane_from_world.transform_point3(*point);
        let beyond = DVec2::new(at.x, at.z).abs() - receiver.half_extent_m;
        beyond.max(DVec2::ZERO).extend(at.y).length()
    };
    let nearest_m = points_in_world
        .iter()
        .map(distance_m)
        .fold(f64::INFINITY, f64::min);
    let own = receiver.world_from_plane.to_cols_array();
    [nearest_m]
        .into_iter()
        .chain(own)
        .chain(receiver.half_extent_m.to_array())
        .collect()
}
