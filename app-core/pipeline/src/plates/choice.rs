//! Plates from several cameras: the choice of those from which a view's plate is composed.

use glam::{DMat4, DVec2, DVec3, UVec2, Vec3};

use crate::geometry::displacement::is_same_view;
use crate::geometry::rect::PixelRect;
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;
use crate::passes::globals::columns;
use crate::passes::plate::{MAX_PLATES, PlateView, PlateViews};
use crate::plates::sight::{PointOn, Sight};
use app_scene::scene::{MAX_RECEIVERS, Plate, Scene};

/// Distance between the pixels of the region at which the plates' coverage is tested: every larger
/// gap is detected.
const COVERED_STEP_PX: u32 = 8;

/// The plates from which a view's plate is composed.
pub(crate) struct PlateChoice {
    /// Indices in the scene's list.
    pub(crate) indices: Vec<usize>,
    /// Whether the only plate was taken by this very camera.
    pub(crate) is_same_view: bool,
}

/// Chooses from the scene's plates for a camera that looks at `toy_in_world`; the footprint has
/// `corners_in_world`.
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
    let cosine = |plate: &Plate| direction(&view_of(scene, plate)).dot(from_here);
    let cosines: Vec<f64> = plates.iter().map(cosine).collect();
    let mut indices: Vec<usize> = (0..plates.len()).collect();
    indices.sort_by(|a, b| cosines[*b].total_cmp(&cosines[*a]));
    indices.truncate(MAX_PLATES);
    // The order does not depend on the camera, so that they need not be uploaded again.
    indices.sort_unstable();
    PlateChoice {
        indices,
        is_same_view: false,
    }
}

/// Share of the receivers' area in `rect` that the chosen plates show too; 1 if there is no
/// receiver at all.
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
    let end_px = DVec2::new(f64::from(scene.width_px), f64::from(scene.height_px)) - 1.0;
    let is_inside = |px: DVec2| px.cmpge(DVec2::ONE).all() && px.cmple(end_px).all();
    let plates = choice.indices.iter().map(|index| &scene.plates[*index]);
    let plate_sights: Vec<Sight<'_>> = plates
        .map(|plate| Sight::new(&view_of(scene, plate), layout.receivers))
        .collect();
    let is_covered = |point: PointOn| {
        let mut sights = plate_sights.iter();
        sights.any(|sight| sight.image_px_of(point).is_some_and(is_inside))
    };
    let sight = Sight::new(view, layout.receivers);
    let (mut n_seen, mut n_covered) = (0.0, 0.0);
    for point in grid_over(rect).filter_map(|px| sight.nearest(px)) {
        n_seen += 1.0;
        n_covered += f64::from(u8::from(is_covered(point)));
    }
    if n_seen > 0.0 { n_covered / n_seen } else { 1.0 }
}

/// Positions from one border to the other, at most [`COVERED_STEP_PX`] apart.
fn grid_over(rect: &PixelRect) -> impl Iterator<Item = DVec2> {
    let n_steps = (rect.size_px / COVERED_STEP_PX).max(UVec2::ONE) + 1;
    let (origin_px, size_px) = (rect.origin_px.as_dvec2(), rect.size_px.as_dvec2());
    let positions = (0..=n_steps.y).flat_map(move |y| (0..=n_steps.x).map(move |x| UVec2::new(x, y)));
    positions.map(move |at| origin_px + at.as_dvec2() * size_px / n_steps.as_dvec2())
}

/// The uniforms of the chosen plates; `gains` are the gains of all plates of the scene.
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

/// The view of a plate's camera.
pub(crate) fn view_of(scene: &Scene, plate: &Plate) -> View {
    View::new(UVec2::new(scene.width_px, scene.height_px), &plate.camera)
}
