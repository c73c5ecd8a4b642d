//! Plates from several cameras: which of them a view's plate is made of, and how they differ in exposure.

use glam::{DMat4, DVec2, DVec3, UVec2};

use crate::gpu::layout::{MAX_PLATES, MAX_RECEIVERS, PlateView, PlateViews};
use crate::maps::linear_from_srgb;
use crate::region::PixelRect;
use crate::scene::{Image, Plate, Receiver, Scene};
use crate::view::{Place, View, columns};

/// Cameras closer than this, in matrix elements, are one camera.
pub(crate) const SAME_CAMERA: f64 = 1e-6;
/// Places along each side of a plate where its exposure is compared with another's.
const N_COMPARED: u32 = 48;
/// Places along each side of the region where it is checked that a plate shows them.
const N_COVERED: u32 = 17;
/// Half the side of the square that is averaged there: misplaced plates still agree.
const COMPARED_RADIUS_PX: i64 = 3;
/// Codes that are neither mostly quantisation nor perhaps clipped.
const EVIDENT_CODES: std::ops::RangeInclusive<u8> = 10..=250;
/// Difference between two plates, relative, at which a place counts half.
const CAUCHY_SCALE: f64 = 0.05;
/// Fewer places than this tell no exposure.
const FEWEST_COMPARED: usize = 16;
/// Steps of the reweighted least squares.
const N_STEPS: usize = 8;

/// The plates that a view's plate is made of.
pub(crate) struct PlateChoice {
    /// Places in the scene's list.
    pub(crate) indices: Vec<usize>,
    /// The one plate was taken from this very camera.
    pub(crate) is_same_view: bool,
}

/// Chooses from the scene's plates for a camera that looks at `toy_in_world`.
pub(crate) fn choose(scene: &Scene, world_from_camera: &DMat4, toy_in_world: DVec3) -> PlateChoice {
    let plates = &scene.plates;
    let is_same = |plate: &Plate| {
        plate
            .world_from_camera
            .abs_diff_eq(*world_from_camera, SAME_CAMERA)
    };
    if let Some(same) = plates.iter().position(is_same) {
        return PlateChoice {
            indices: vec![same],
            is_same_view: true,
        };
    }
    let direction = |camera: &DMat4| (camera.w_axis.truncate() - toy_in_world).normalize_or_zero();
    let from_here = direction(world_from_camera);
    let cosine = |index: &usize| direction(&plates[*index].world_from_camera).dot(from_here);
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
pub(crate) fn covered_share(
    scene: &Scene,
    place: &Place<'_>,
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
        let Some((receiver, in_plane)) = nearest_receiver(view, place.receivers, px) else {
            continue;
        };
        n_seen += 1.0;
        let is_covered = plate_views.iter().any(|plate_view| {
            let end_px = plate_view.image_px.as_dvec2() - 1.0;
            seen_at(plate_view, place.receivers, receiver, in_plane)
                .is_some_and(|px| px.cmpge(DVec2::ONE).all() && px.cmple(end_px).all())
        });
        n_covered += f64::from(u8::from(is_covered));
    }
    if n_seen > 0.0 { n_covered / n_seen } else { 1.0 }
}

/// What the shader knows of the chosen plates; `gains` are those of all of the scene's.
pub(crate) fn plate_views(
    scene: &Scene,
    place: &Place<'_>,
    view: &View,
    choice: &PlateChoice,
    gains: &[DVec3],
) -> PlateViews {
    let cameras = |view: &View| {
        let mut cameras = [[0.0; 4]; MAX_RECEIVERS];
        for (slot, receiver) in cameras.iter_mut().zip(place.receivers) {
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
        for (slot, receiver) in plate.plate_px_from_plane.iter_mut().zip(place.receivers) {
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

/// What brings each plate to the exposure of the first, per channel of linear light; 1 where they share no place.
pub(crate) fn match_exposures(scene: &Scene) -> Vec<DVec3> {
    let mut linear_of_code = [0.0; 256];
    for (code, linear) in (0..=u8::MAX).zip(&mut linear_of_code) {
        *linear = f64::from(linear_from_srgb(f32::from(code) / 255.0));
    }
    let mut gains: Vec<DVec3> = Vec::new();
    for (index, plate) in scene.plates.iter().enumerate() {
        let mut pairs = Vec::new();
        for (other, gain) in scene.plates.iter().zip(&gains) {
            pairs.extend(
                shared_places(scene, plate, other, &linear_of_code)
                    .map(|(here, there)| (here, *gain * there)),
            );
        }
        let gain = if index == 0 || pairs.len() < FEWEST_COMPARED {
            DVec3::ONE
        } else {
            DVec3::from_array([0, 1, 2].map(|channel| robust_gain(&pairs, channel)))
        };
        gains.push(gain);
    }
    gains
}

/// Colours of the places that both plates show.
fn shared_places<'a>(
    scene: &'a Scene,
    plate: &'a Plate,
    other: &'a Plate,
    linear_of_code: &'a [f64; 256],
) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
    let (view, other_view) = (view_of(scene, plate), view_of(scene, other));
    let spacing = view.image_px.as_dvec2() / f64::from(N_COMPARED);
    let places = (0..N_COMPARED * N_COMPARED).map(|k| UVec2::new(k % N_COMPARED, k / N_COMPARED));
    places.filter_map(move |at| {
        let px = (at.as_dvec2() + 0.5) * spacing;
        let (receiver, in_plane) = nearest_receiver(&view, &scene.receivers, px)?;
        let other_px = seen_at(&other_view, &scene.receivers, receiver, in_plane)?;
        let here = mean_color(&plate.image, px, linear_of_code)?;
        Some((here, mean_color(&other.image, other_px, linear_of_code)?))
    })
}

/// Where a camera sees a point of one of `receivers`, be it beyond its picture; none where another one hides it, or the
/// receiver itself, seen from behind.
fn seen_at(view: &View, receivers: &[Receiver], receiver: &Receiver, in_plane: DVec2) -> Option<DVec2> {
    let at = view.image_px_from_plane(&receiver.world_from_plane) * in_plane.extend(1.0);
    let px = (at.z > 0.0).then(|| at.truncate() / at.z)?;
    let (nearest, _) = nearest_receiver(view, receivers, px)?;
    std::ptr::eq(nearest, receiver).then_some(px)
}

/// The nearest receiver seen at a pixel, and where; none where that is its back.
fn nearest_receiver<'a>(
    view: &View,
    receivers: &'a [Receiver],
    image_px: DVec2,
) -> Option<(&'a Receiver, DVec2)> {
    let hits = receivers.iter().filter_map(|receiver| {
        let plane_from_px = view.image_px_from_plane(&receiver.world_from_plane).inverse();
        let at = plane_from_px * image_px.extend(1.0);
        let in_plane = (at.z > 0.0).then(|| at.truncate() / at.z)?;
        let is_on = in_plane.abs().cmple(receiver.half_extent_m).all();
        is_on.then_some((at.z, receiver, in_plane))
    });
    hits.max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, receiver, in_plane)| (receiver, in_plane))
        .filter(|(receiver, _)| view.sees_front_of(receiver))
}

/// Mean linear colour around a pixel; none at the border, or where a code is too dark or too bright to tell.
fn mean_color(image: &Image, px: DVec2, linear_of_code: &[f64; 256]) -> Option<DVec3> {
    #[allow(clippy::cast_possible_truncation, reason = "a pixel of an image")]
    let centre = [px.x.floor() as i64, px.y.floor() as i64];
    let side = 2 * COMPARED_RADIUS_PX + 1;
    let mut sum = DVec3::ZERO;
    for k in 0..side * side {
        let x = u32::try_from(centre[0] + k % side - COMPARED_RADIUS_PX).ok()?;
        let y = u32::try_from(centre[1] + k / side - COMPARED_RADIUS_PX).ok()?;
        if x >= image.width_px || y >= image.height_px {
            return None;
        }
        let first = 4 * (y as usize * image.width_px as usize + x as usize);
        let codes = image.rgba8.get(first..first + 3)?;
        if codes.iter().any(|code| !EVIDENT_CODES.contains(code)) {
            return None;
        }
        sum += DVec3::from_array([0, 1, 2].map(|channel| linear_of_code[usize::from(codes[channel])]));
    }
    #[allow(clippy::cast_precision_loss, reason = "49")]
    let n_pixels = (side * side) as f64;
    Some(sum / n_pixels)
}

/// The factor that brings the first of each pair to the second, by reweighted least squares.
fn robust_gain(pairs: &[(DVec3, DVec3)], channel: usize) -> f64 {
    let mut gain: Option<f64> = None;
    for _ in 0..N_STEPS {
        let (mut product, mut energy) = (0.0, 0.0);
        for (here, there) in pairs.iter().map(|(a, b)| (a[channel], b[channel])) {
            let relative = gain.map_or(0.0, |gain| (gain * here - there) / (CAUCHY_SCALE * there));
            let weight = 1.0 / (1.0 + relative * relative);
            product += weight * here * there;
            energy += weight * here * here;
        }
        gain = Some(product / energy);
    }
    gain.filter(|gain| gain.is_finite() && *gain > 0.0).unwrap_or(1.0)
}

fn view_of(scene: &Scene, plate: &Plate) -> View {
    View::new(
        UVec2::new(scene.width_px, scene.height_px),
        scene.intrinsics,
        &plate.world_from_camera,
    )
}
