//! Plates from several cameras: which of them a view's plate is made of.

use glam::{DMat4, DVec2, DVec3, UVec2, Vec3};

use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::displacement::is_same_view;
use crate::geometry::rect::PixelRect;
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;
use crate::passes::globals::columns;
use crate::passes::plate::{MAX_PLATES, PlateView, PlateViews};
use crate::scene::{MAX_RECEIVERS, Plate, Scene};

/// Places along each side of the region where it is checked that a plate shows them.
const N_COVERED: u32 = 17;

/// The plates that a view's plate is made of.
pub(crate) struct PlateChoice {
    /// Places in the scene's list.
    pub(crate) indices: Vec<usize>,
    /// The one plate was taken from this very camera.
    pub(crate) is_same_view: bool,
}

/// Chooses from the scene's plates for a camera that looks at `toy_in_world`; what is worked on has `corners_in_world`.
pub(crate) fn choose(
    scene: &Scene,
    view: &View,
    corners_in_world: &[DVec3],
    toy_in_world: DVec3,
) -> PlateChoice {
    let plates = &scene.plates;
    let is_same = |plate: &Plate| is_same_view([&view_of(scene, plate), view], corners_in_world);
    if let Some(same) = plates.iter().position(is_same) {
        return PlateChoice {
            indices: vec![same],
            is_same_view: true,
        };
    }
    let direction = |view: &View| (view.camera_in(&DMat4::IDENTITY) - toy_in_world).normalize_or_zero();
    let from_here = direction(view);
    let cosine = |index: &usize| direction(&view_of(scene, &plates[*index])).dot(from_here);
    let mut indices: Vec<usize> = (0..plates.len()).collect();
    indices.sort_by(|a, b| cosine(b).total_cmp(&cosine(a)));
    indices.truncate(MAX_PLATES);
    // In the same order whatever the camera, so that they need not be uploaded anew.
    indices.sort_unstable();
    PlateChoice {
        indices,
        is_same_view: false,
    }
}

/// Share of what the receivers show in `rect` that the chosen plates show too; 1 where there is no receiver at all.
pub(crate) fn covered_fraction(
    scene: &Scene,
    layout: &SceneLayout<'_>,
    view: &View,
    rect: &PixelRect,
    choice: &PlateChoice,
) -> f64 {
    if choice.is_same_view {
        return 1.0;
    }
    let plate_views: Vec<View> = choice
        .indices
        .iter()
        .map(|index| view_of(scene, &scene.plates[*index]))
        .collect();
    let n_side = N_COVERED - 1;
    let places = (0..N_COVERED * N_COVERED).map(|k| UVec2::new(k % N_COVERED, k / N_COVERED));
    let (mut n_seen, mut n_covered) = (0.0, 0.0);
    for at in places {
        let px = rect.origin_px.as_dvec2() + (at * rect.size_px).as_dvec2() / f64::from(n_side);
        let Some((receiver, in_plane)) = nearest_receiver(view, layout.receivers, px) else {
            continue;
        };
        n_seen += 1.0;
        let is_covered = plate_views.iter().any(|plate_view| {
            let end_px = plate_view.image_px.as_dvec2() - 1.0;
            seen_at(plate_view, layout.receivers, receiver, in_plane)
                .is_some_and(|px| px.cmpge(DVec2::ONE).all() && px.cmple(end_px).all())
        });
        n_covered += f64::from(u8::from(is_covered));
    }
    if n_seen > 0.0 { n_covered / n_seen } else { 1.0 }
}

/// What the shader knows of the chosen plates; `gains` are those of all of the scene's.
pub(crate) fn plate_views(
    scene: &Scene,
    layout: &SceneLayout<'_>,
    view: &View,
    choice: &PlateChoice,
    gains: &[DVec3],
) -> PlateViews {
    let cameras = |view: &View| {
        let mut cameras = [[0.0; 4]; MAX_RECEIVERS];
        for (slot, receiver) in cameras.iter_mut().zip(layout.receivers) {
            let camera = view.camera_in(&receiver.world_from_plane).as_vec3();
            *slot = camera.extend(1.0).to_array();
        }
        cameras
    };
    let mut views: PlateViews = bytemuck::Zeroable::zeroed();
    for (slot, index) in views.plates.iter_mut().zip(&choice.indices) {
        let plate_view = view_of(scene, &scene.plates[*index]);
        let mut plate = PlateView {
            camera_in_plane: cameras(&plate_view),
            gain: gains[*index].as_vec3().extend(1.0).to_array(),
            ..bytemuck::Zeroable::zeroed()
        };
        for (slot, receiver) in plate.plate_px_from_plane.iter_mut().zip(layout.receivers) {
            *slot = columns(plate_view.image_px_from_plane(&receiver.world_from_plane));
        }
        *slot = plate;
    }
    #[allow(clippy::cast_possible_truncation, reason = "at most four")]
    let n_plates = choice.indices.len().min(MAX_PLATES) as u32;
    PlateViews {
        camera_in_plane: cameras(view),
        n_plates,
        is_same_view: u32::from(choice.is_same_view),
        ..views
    }
}

/// The same at another exposure.
pub(crate) fn exposed(views: &PlateViews, gain: DVec3) -> PlateViews {
    let mut views = *views;
    for plate in &mut views.plates {
        let [r, g, b, _] = plate.gain;
        plate.gain = (Vec3::new(r, g, b) * gain.as_vec3()).extend(1.0).to_array();
    }
    views
}

/// Where a camera sees a point of one of `receivers`, be it beyond its picture; none where another one hides it, or the
/// receiver itself, seen from behind.
pub(crate) fn seen_at(
    view: &View,
    receivers: &[AnchoredReceiver],
    receiver: &AnchoredReceiver,
    in_plane: DVec2,
) -> Option<DVec2> {
    let at = view.image_px_from_plane(&receiver.world_from_plane) * in_plane.extend(1.0);
    let px = (at.z > 0.0).then(|| at.truncate() / at.z)?;
    let (nearest, _) = nearest_receiver(view, receivers, px)?;
    std::ptr::eq(nearest, receiver).then_some(px)
}

/// The nearest receiver seen at a pixel, and where; none where that is its back.
pub(crate) fn nearest_receiver<'a>(
    view: &View,
    receivers: &'a [AnchoredReceiver],
    image_px: DVec2,
) -> Option<(&'a AnchoredReceiver, DVec2)> {
    let hits = receivers.iter().filter_map(|receiver| {
        let plane_from_px = view.image_px_from_plane(&receiver.world_from_plane).inverse();
        let at = plane_from_px * image_px.extend(1.0);
        let in_plane = (at.z > 0.0).then(|| at.truncate() / at.z)?;
        receiver
            .rect
            .holds(in_plane)
            .then_some((at.z, receiver, in_plane))
    });
    hits.max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, receiver, in_plane)| (receiver, in_plane))
        .filter(|(receiver, _)| view.sees_front_of(&receiver.world_from_plane))
}

/// The view of a plate's camera.
pub(crate) fn view_of(scene: &Scene, plate: &Plate) -> View {
    View::new(UVec2::new(scene.width_px, scene.height_px), &plate.camera)
}
