//! Choice of the table: the card's plane if it is visible, otherwise a plane of the platform.

use glam::{DMat4, DVec2};

use super::ghost::seen_at;
use app_scene::camera_frame::{CameraFrame, FoundPlane};
use app_scene::scene::{Camera, MAX_RECEIVERS, Pose};
use app_scene::toy::Toy;

/// Number of the card's plane, which no platform assigns.
const CARD: u64 = u64::MAX;
/// Extent of the table around the card, in metres.
const AROUND_CARD_M: f64 = 0.6;

/// Largest height in metres at which a level plane above the table counts as a piece of it, as
/// trackers find them.
const LEAST_STEP_M: f64 = 0.008;
/// Largest tilt in radians of such a piece, and the tilt above which a plane cannot support things.
const SAME_TILT: f64 = 0.06;
const STEEPEST: f64 = 0.8;
/// Largest reach of a shadow, relative to the toy's size: that of light from 18 degrees above the
/// table.
const REACH: f64 = 3.0;

/// The table below a tapped pixel.
pub(super) fn table_at(frame: &CameraFrame, camera: &Camera, pixel: DVec2) -> Option<FoundPlane> {
    let hit = |plane: &FoundPlane| {
        let place = seen_at(&plane.world_from_plane, camera, pixel)?;
        let is_on = place.abs().cmple(plane.half_extent_m).all();
        let eye = camera.world_from_camera.w_axis.truncate();
        let eye = plane.world_from_plane.inverse().transform_point3(eye);
        is_on.then_some(place.distance(DVec2::new(eye.x, eye.z)))
    };
    // The printed length gives a more accurate plane than motion does.
    let card = frame.world_from_card.as_ref().map(around_card);
    if let Some(card) = card.filter(|card| hit(card).is_some()) {
        return Some(card);
    }
    let planes = frame.planes.iter();
    let hits = planes.filter_map(|plane| Some((hit(plane)?, plane)));
    let nearest = hits.min_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map(|(_, plane)| plane.clone())
}

/// The same table in the frame's version; `None` if the frame does not contain it.
pub(super) fn as_reported_now(table: &FoundPlane, frame: &CameraFrame) -> Option<FoundPlane> {
    if table.id == CARD {
        return frame.world_from_card.as_ref().map(around_card);
    }
    frame.planes.iter().find(|plane| plane.id == table.id).cloned()
}

/// Planes above the table that the shadow of a toy may reach, from the nearest, at most as many as
/// shadows are retargeted on.
pub(super) fn beside<'a>(
    table: &FoundPlane,
    planes: &'a [FoundPlane],
    world_from_object: &DMat4,
    toy: &Toy,
) -> Vec<&'a FoundPlane> {
    let Ok(bounds) = toy.bounds_of_pose(&Pose::Authored) else {
        return Vec::new();
    };
    let size_m = world_from_object
        .transform_vector3((bounds.max - bounds.min).as_dvec3())
        .length();
    let table_from_world = table.world_from_plane.inverse();
    let up = table.world_from_plane.y_axis.truncate();
    let others = planes.iter().filter(|plane| {
        let tilt_cosine = plane.world_from_plane.y_axis.truncate().dot(up);
        let height_m = table_from_world
            .transform_point3(plane.world_from_plane.w_axis.truncate())
            .y;
        // A tracker finds a table in pieces, and surfaces below it.
        let is_above = height_m > LEAST_STEP_M || tilt_cosine < SAME_TILT.cos() && height_m > 0.0;
        plane.id != table.id && is_above && height_m < size_m && tilt_cosine > STEEPEST.cos()
    });
    let distance_m = |plane: &FoundPlane| {
        let toy = plane
            .world_from_plane
            .inverse()
            .transform_point3(world_from_object.w_axis.truncate());
        (DVec2::new(toy.x, toy.z).abs() - plane.half_extent_m)
            .max(DVec2::ZERO)
            .length()
    };
    let mut others: Vec<(f64, &FoundPlane)> = others.map(|plane| (distance_m(plane), plane)).collect();
    others.retain(|(distance_m, _)| *distance_m < REACH * size_m);
    others.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut nearest: Vec<&FoundPlane> = Vec::new();
    for (_, plane) in others {
        // A plane that a platform has merged into another is listed once more, with its shape.
        let is_listed = nearest.iter().any(|other| is_of_same_shape(other, plane));
        if !is_listed && nearest.len() < MAX_RECEIVERS - 1 {
            nearest.push(plane);
        }
    }
    nearest
}

fn is_of_same_shape(one: &FoundPlane, other: &FoundPlane) -> bool {
    let shape = |plane: &FoundPlane| (plane.world_from_plane, plane.half_extent_m);
    shape(one) == shape(other)
}

fn around_card(world_from_card: &DMat4) -> FoundPlane {
    FoundPlane {
        id: CARD,
        world_from_plane: *world_from_card,
        half_extent_m: DVec2::splat(AROUND_CARD_M),
    }
}
