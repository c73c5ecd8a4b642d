//! Which plane is the table: that of the card, where it is seen, or one that the platform has found.

use glam::{DMat4, DVec2};

use super::ghost::seen_at;
use app_scene::camera_frame::{CameraFrame, FoundPlane};
use app_scene::scene::Camera;

/// Number of the card's plane, which no platform gives.
const CARD: u64 = u64::MAX;
/// The table reaches so far around the card, in metres.
const AROUND_CARD_M: f64 = 0.6;

/// The table that a tap on a pixel means.
pub(super) fn table_at(frame: &CameraFrame, camera: &Camera, pixel: DVec2) -> Option<FoundPlane> {
    let hit = |plane: &FoundPlane| {
        let place = seen_at(&plane.world_from_plane, camera, pixel)?;
        let is_on = place.abs().cmple(plane.half_extent_m).all();
        let eye = camera.world_from_camera.w_axis.truncate();
        let eye = plane.world_from_plane.inverse().transform_point3(eye);
        is_on.then_some(place.distance(DVec2::new(eye.x, eye.z)))
    };
    // A printed length tells the card's plane better than motion tells the others.
    let card = frame.world_from_card.as_ref().map(around_card);
    if let Some(card) = card.filter(|card| hit(card).is_some()) {
        return Some(card);
    }
    let planes = frame.planes.iter();
    let hits = planes.filter_map(|plane| Some((hit(plane)?, plane)));
    let nearest = hits.min_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map(|(_, plane)| plane.clone())
}

/// The same table as it is told now; none where it is not.
pub(super) fn as_told_now(table: &FoundPlane, frame: &CameraFrame) -> Option<FoundPlane> {
    if table.id == CARD {
        return frame.world_from_card.as_ref().map(around_card);
    }
    frame.planes.iter().find(|plane| plane.id == table.id).cloned()
}

fn around_card(world_from_card: &DMat4) -> FoundPlane {
    FoundPlane {
        id: CARD,
        world_from_plane: *world_from_card,
        half_extent_m: DVec2::splat(AROUND_CARD_M),
    }
}
