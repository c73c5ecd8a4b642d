//! `plate`: the place as this camera would have taken it, from plates of this camera and of others.

use std::sync::Arc;

use app_core::frame::Warning;
use app_core::preset::Preset;
use app_core::scene::{Camera, Image, Plate};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::Map;
use glam::{DMat4, DVec2, DVec3, DVec4, UVec2};
use reference::model::{ReceiverPoint, Region, centre_px};
use reference::raster::{Raster, texels_of};

use crate::cores::{SharedCore, core_on};
use crate::device::Device;
use crate::errors::Errors;
use crate::photo::{Photo, photograph};
use crate::run::{crop, input, plate_of, raster, runs, scene};
use crate::setups::{Beside, Setup, WALL};
use crate::stand::Stand;

/// Offsets of cameras from their targets: the view's, one beside it, and one from the other side.
pub(crate) const HERE: DVec3 = DVec3::new(0.15, 0.34, 0.41);
const BESIDE: DVec3 = DVec3::new(0.26, 0.36, 0.34);
const AWAY: DVec3 = DVec3::new(-0.4, 0.42, 0.12);

pub(crate) const SETUP: Setup = WALL.of_size(231, 173);

fn without_wall() -> Setup {
    Setup {
        beside: Beside::Nothing,
        lights: &WALL.lights[..1],
        ..SETUP
    }
}

fn photo(stand: &Stand) -> Photo {
    Photo::plain(stand.setup.lights.len())
}

/// The plate of a frame from `HERE`, its region, and the core.
fn plate_from(plates: Vec<Plate>, preset: Preset, stand: &Stand) -> (Raster<DVec4>, PixelRect, SharedCore) {
    let frame = photo(stand).frame(stand, &stand.physical);
    let with_plates = scene(stand, &frame).with_plates(plates);
    let mut core = core_on(with_plates, preset).unwrap();
    let rect = core.frame(&input(stand, &frame)).unwrap().region.unwrap();
    let plate = raster(&core.read_map(Map::Plate).unwrap().unwrap());
    (plate, rect, core)
}

/// Texels of a region, with the receivers' points.
fn points(region: &Region) -> impl Iterator<Item = (UVec2, ReceiverPoint)> + '_ {
    let size = region.size_px;
    let texels = texels_of(size);
    texels.filter_map(|texel| Some((texel, region.receiver_point(centre_px(texel))?)))
}

/// Distance of a point from the border of another camera's picture, inside it; negative if it is
/// outside, or if another receiver hides it.
fn inside_px(stand: &Stand, point: ReceiverPoint) -> f64 {
    let region = stand.region(&stand.whole_image());
    let px = region.receivers[point.receiver].region_px(point.in_plane);
    let seen = px.filter(|px| {
        let hit = region.receiver_point(*px);
        hit.is_some_and(|hit| hit.receiver == point.receiver)
    });
    seen.map_or(-1.0, |px| px.min(region.size_px.as_dvec2() - px).min_element())
}

/// Whether the filter's sixteen texels around a pixel all show one receiver.
fn is_one_receiver(region: &Region, px: DVec2, receiver: usize) -> bool {
    let steps = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y, DVec2::ZERO];
    let mut around = steps.iter().map(|step| region.receiver_point(px + 4.0 * *step));
    around.all(|hit| hit.is_some_and(|hit| hit.receiver == receiver))
}

#[test]
fn same_camera_gives_its_codes_bit_for_bit() {
    let decoded = Device::shared().decoded();
    let code_of = |linear: f64| {
        let nearest = (0..=255u8).min_by(|a, b| {
            let off = |code: &u8| (decoded[usize::from(*code)] - linear).abs();
            off(a).total_cmp(&off(b))
        });
        nearest.unwrap()
    };
    for run in runs() {
        let [plate, _] = photograph(&run.stand);
        let expected = crop(&plate, &run.plan.region, &decoded);
        for (actual, expected) in run.pictures.plate.texels().iter().zip(expected.texels()) {
            let codes = |color: &DVec3| color.to_array().map(code_of);
            assert_eq!(codes(actual), codes(expected), "{}", run.stand.setup.name);
        }
    }
}

#[test]
fn plate_of_another_camera_is_the_place_as_seen_from_here() {
    let (here, beside) = (Stand::seen_from(SETUP, HERE), Stand::seen_from(SETUP, BESIDE));
    let photo = photo(&here);
    let plates = vec![plate_of(&beside, &photo.plate(&beside))];
    let (plate, rect, _) = plate_from(plates, Preset::Balanced, &here);
    let region = here.region(&rect);
    let whole = beside.region(&beside.whole_image());
    let (mut n_seen, mut n_hidden) = ([0; 2], 0);
    let mut pairs = Vec::new();
    for (texel, point) in points(&region) {
        let plate_px = whole.receivers[point.receiver].region_px(point.in_plane).unwrap();
        if whole
            .receiver_point(plate_px)
            .is_some_and(|hit| hit.receiver != point.receiver)
        {
            n_hidden += 1;
            assert!(
                plate.at(texel).w < 1.0,
                "{texel}: a wall hides it from the other camera"
            );
        }
        if inside_px(&beside, point) < 3.0
            || !is_one_receiver(&region, centre_px(texel), point.receiver)
            || !is_one_receiver(&whole, plate_px, point.receiver)
        {
            continue;
        }
        n_seen[point.receiver] += 1;
        assert_eq!(plate.at(texel).w, 1.0, "{texel} is not photographed");
        let expected = photo.plate_at(&region, point);
        pairs.extend((0..3).map(|channel| (plate.at(texel)[channel] / expected[channel], 1.0)));
    }
    assert!(
        n_seen.iter().all(|n| *n > 1000) && n_hidden > 20,
        "{n_seen:?}, {n_hidden}"
    );
    // Half a code at code 70 is 1 %; a quarter of a pixel would be equally large. Measured: 0.013.
    Errors::between(pairs).check_all("plate of another camera", 0.02);
}

#[test]
fn what_no_plate_shows_is_not_there() {
    let setup = without_wall();
    // A closer camera: it sees only a part of the place.
    let (here, close) = (
        Stand::seen_from(setup, HERE),
        Stand::seen_from(setup, 0.4 * BESIDE),
    );
    let plates = vec![plate_of(&close, &photo(&close).plate(&close))];
    // The published method keeps its plate as photographed.
    let (plate, rect, _) = plate_from(plates, Preset::Paper, &here);
    let region = here.region(&rect);
    let (mut n_seen, mut n_unseen) = (0, 0);
    for (texel, point) in points(&region) {
        let inside_px = inside_px(&close, point);
        if inside_px.abs() > 0.1 {
            let expected = f64::from(u8::from(inside_px > 0.0));
            assert_eq!(plate.at(texel).w, expected, "{texel}: {inside_px} px inside");
            n_seen += u32::from(inside_px > 0.0);
            n_unseen += u32::from(inside_px < 0.0);
        }
    }
    assert!(n_seen > 1000 && n_unseen > 1000, "{n_seen}, {n_unseen}");
}

/// A picture of one code, which is no measure of its exposure if it is white.
pub(crate) fn flat(code: u8) -> Arc<Image> {
    let UVec2 { x, y } = SETUP.image_px;
    Arc::new(Image {
        width_px: x,
        height_px: y,
        rgba8: [code, code, code, 255].repeat((x * y) as usize),
    })
}

#[test]
fn of_two_plates_the_one_that_saw_it_better_wins() {
    let here = Stand::seen_from(SETUP, HERE);
    let (beside, away) = (Stand::seen_from(SETUP, BESIDE), Stand::seen_from(SETUP, AWAY));
    let grey = Device::shared().decoded()[128];
    for order in [[0, 1], [1, 0]] {
        let both = [plate_of(&away, &flat(255)), plate_of(&beside, &flat(128))];
        let plates = order.map(|k: usize| both[k].clone()).to_vec();
        let (plate, rect, _) = plate_from(plates, Preset::Balanced, &here);
        let region = here.region(&rect);
        let (mut n_better, mut n_only) = (0, 0);
        for (texel, point) in points(&region) {
            let (in_beside, in_away) = (inside_px(&beside, point), inside_px(&away, point));
            let color = plate.at(texel).x;
            if in_beside > 32.0 {
                n_better += 1;
                // The weight of the other plate is below the limit: the remaining error is that of
                // codes in halves. Measured: 9e-5.
                assert!((color - grey).abs() < 1e-3, "{texel}: {color}, not {grey}");
            } else if in_beside < 0.0 && in_away > 0.0 {
                n_only += 1;
                assert!((color - 1.0).abs() < 1e-3, "{texel}: {color}");
            }
        }
        assert!(n_better > 1000 && n_only > 100, "{n_better}, {n_only}");
    }
}

#[test]
fn exposures_of_plates_are_matched_to_the_first() {
    let here = Stand::seen_from(SETUP, HERE);
    let first = photo(&here);
    let gains = [DVec3::ONE, DVec3::new(1.35, 0.8, 1.1), DVec3::new(0.7, 0.75, 0.9)];
    let offsets = [AWAY, BESIDE, DVec3::new(0.02, 0.4, 0.4)];
    let plates = offsets.iter().zip(gains).map(|(offset, gain)| {
        let stand = Stand::seen_from(SETUP, *offset);
        plate_of(&stand, &first.exposed_plate(&stand, gain))
    });
    let plates: Vec<Plate> = plates.collect();
    // Each of the differently exposed plates alone with the first, and both.
    for others in [vec![1], vec![2], vec![1, 2]] {
        let chosen = std::iter::once(0)
            .chain(others.clone())
            .map(|k| plates[k].clone());
        let (plate, rect, _) = plate_from(chosen.collect(), Preset::Balanced, &here);
        let region = here.region(&rect);
        let (mut sum, mut n) = (DVec3::ZERO, 0.0);
        for (texel, point) in points(&region).filter(|(texel, _)| plate.at(*texel).w == 1.0) {
            sum += plate.at(texel).truncate() / first.plate_at(&region, point);
            n += 1.0;
        }
        let exposure = sum / n;
        // Measured: 0.0035.
        assert!(
            (exposure - 1.0).abs().max_element() < 0.005,
            "{others:?}: {exposure}"
        );
    }
}

/// A camera turned to the left about its own vertical axis by this angle.
pub(crate) fn turned(camera: &Camera, left_rad: f64) -> Camera {
    Camera {
        world_from_camera: camera.world_from_camera * DMat4::from_rotation_y(left_rad),
        ..*camera
    }
}

#[test]
fn a_narrow_gap_between_plates_is_reported() {
    const HALF_GAP_PX: f64 = 3.5;
    let here = Stand::seen_from(SETUP, HERE);
    let k = &here.camera.intrinsics;
    let angle_rad = |px: f64| (px / k.fx_px).atan();
    let to_right_border = f64::from(SETUP.image_px.x) - k.cx_px;
    let plates_apart_by = |half_gap_px: f64, aside_px: f64| {
        let left_rad = angle_rad(to_right_border) + angle_rad(half_gap_px - aside_px);
        let right_rad = angle_rad(k.cx_px) + angle_rad(half_gap_px + aside_px);
        let cameras = [turned(&here.camera, left_rad), turned(&here.camera, -right_rad)];
        let plate = |camera| Plate {
            camera,
            image: flat(128),
        };
        cameras.map(plate).to_vec()
    };
    let frame = photo(&here).frame(&here, &here.physical);
    let scene_with = |plates| scene(&here, &frame).with_plates(plates);
    let together = scene_with(plates_apart_by(-HALF_GAP_PX, 0.0));
    let mut core = core_on(together.clone(), Preset::Balanced).unwrap();
    // At any position relative to the tested pixels.
    let apart = [0.0, 4.0, 8.0, 12.0].map(|aside_px| scene_with(plates_apart_by(HALF_GAP_PX, aside_px)));
    for (scene, is_gap) in [(together, false)]
        .into_iter()
        .chain(apart.map(|scene| (scene, true)))
    {
        core.set_scene(scene, Preset::Balanced).unwrap();
        let warnings = core.frame(&input(&here, &frame)).unwrap().warnings;
        let is_partial = warnings
            .iter()
            .any(|warning| matches!(warning, Warning::PlatePartial { fraction } if *fraction > 0.8));
        assert_eq!(is_partial, is_gap, "{warnings:?}");
    }
}

/// Low on either side of the toy, such that they face each other, one near and one far.
#[test]
fn what_only_a_plate_from_the_other_side_shows_is_there() {
    let setup = without_wall();
    let here = Stand::seen_from(setup, DVec3::new(0.1, 0.12, 0.5));
    for far in [1.0, 6.0] {
        let across = Stand::seen_from(setup, far * DVec3::new(-0.1, 0.08, -0.5));
        let plates = vec![plate_of(&across, &photo(&across).plate(&across))];
        let (plate, rect, _) = plate_from(plates, Preset::Paper, &here);
        let region = here.region(&rect);
        let seen: Vec<UVec2> = points(&region)
            .filter(|(_, point)| inside_px(&across, *point) > 0.1)
            .map(|(texel, _)| texel)
            .collect();
        assert!(seen.len() > 1000, "{far}: {} are seen", seen.len());
        let missing = seen.iter().filter(|texel| plate.at(**texel).w < 1.0).count();
        assert_eq!(missing, 0, "{far}: of {}", seen.len());
    }
}
