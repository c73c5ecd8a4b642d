//! Lists with entries that tell nothing: lights that are not used or have no visible shadow, receivers that
//! the toy does not stand on. All others count as if these were not listed.

use std::sync::Arc;

use app_core::alignment::{Aligner, Alignment, AlignmentWarning};
use app_core::frame::FrameInput;
use app_core::scene::{Image, Light, PoseUncertainty, Receiver, Scene, Surface};
use glam::{DMat4, DVec2, DVec3};

use super::alignment::{corners, direction, turned_light};
use super::bundled::SESSION;

/// Tolerance of a light's direction: by a whole shadow, and by a part of it.
const WHOLE_DEG: f64 = 0.1;
const PART_DEG: f64 = 0.5;

fn aligned(scene: Scene, lights: &[Light]) -> Alignment {
    let input = SESSION.1.clone().with_lights(Some(lights.into()));
    Aligner::new(scene).align(&input).unwrap()
}

fn off_deg(found: &Light) -> f64 {
    let [found, lamp] = [found, &SESSION.0.lights[0]].map(direction);
    found.angle_between(lamp).to_degrees()
}

fn bulb(position_in_world: DVec3) -> Light {
    Light::Sphere {
        position_in_world,
        radius_m: 0.01,
    }
}

#[test]
fn lights_below_the_table_do_not_count() {
    let below = bulb(DVec3::new(0.2, -0.6, 0.1));
    let listed = [below, turned_light(8.0, 1.0), below, below, below];
    let found = aligned(SESSION.0.clone(), &listed);
    let lights = found.lights.expect("a corrected list");
    assert!(off_deg(&lights[1]) < WHOLE_DEG, "{:?}", found.report);
    assert_eq!(found.report.lights.len(), 1);
    let is_as_listed = |index: usize| lights[index] == listed[index];
    assert!([0, 2, 3, 4].into_iter().all(is_as_listed), "{lights:?}");
    assert_eq!(lights.len(), listed.len());
}

/// The table ends beside the toy, so that a lamp on the other side has no shadow on it.
#[test]
fn a_light_without_a_visible_shadow_holds_up_no_other() {
    let mut scene = SESSION.0.clone();
    let edge_m = corners()
        .into_iter()
        .map(|corner| SESSION.1.world_from_object.transform_point3(corner).x)
        .fold(f64::NEG_INFINITY, f64::max);
    let table = &mut scene.receivers[0];
    table.world_from_plane = DMat4::from_translation((edge_m + table.half_extent_m.x) * DVec3::X);
    let other = bulb(DVec3::new(0.7, 0.75, 0.05));
    let found = aligned(scene, &[turned_light(5.0, 1.0), other]);
    let lights = found.lights.expect("a corrected list");
    assert_eq!(lights.len(), 2, "{:?}", found.report);
    assert!(off_deg(&lights[0]) < PART_DEG, "{:?}", found.report);
}

/// A shelf behind the camera that is as level as the table.
#[test]
fn a_toy_stands_on_the_receiver_below_it() {
    let mut scene = SESSION.0.clone();
    scene.resting = Some(true);
    scene.receivers.push(Receiver {
        name: "shelf".to_owned(),
        world_from_plane: DMat4::from_translation(DVec3::new(0.0, 0.03, 0.9)),
        half_extent_m: DVec2::splat(0.1),
        surface: Surface::Textured,
    });
    let lights = scene.lights.clone();
    let found = aligned(scene, &lights);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let stand = found.report.pose.unwrap().stand.expect("a stand");
    assert!(stand.height_m.abs() < 1e-3, "{stand:?}");
}

/// A picture with each pixel as a square of pixels.
fn enlarged(image: &Image, side: u32) -> Arc<Image> {
    let row = |y: u32| {
        let first = 4 * (y * image.width_px) as usize;
        let texels = image.rgba8[first..].chunks_exact(4).take(image.width_px as usize);
        texels.flat_map(|texel| texel.repeat(side as usize))
    };
    Arc::new(Image {
        width_px: side * image.width_px,
        height_px: side * image.height_px,
        rgba8: (0..side * image.height_px).flat_map(|y| row(y / side)).collect(),
    })
}

/// A pose that is two pixels off in a picture of four megapixels is one off in the halved picture in which it is
/// compared, and good enough there.
#[test]
fn an_outline_is_judged_in_pixels_of_the_picture_that_is_compared() {
    const SIDE: u32 = 4;
    let (scene, input) = &*SESSION;
    let (mut scene, mut input) = (scene.clone(), FrameInput::clone(input));
    (scene.width_px, scene.height_px) = (SIDE * scene.width_px, SIDE * scene.height_px);
    scene.plates[0].image = enlarged(&scene.plates[0].image, SIDE);
    let intrinsics = input.camera.intrinsics.scaled(f64::from(SIDE));
    scene.plates[0].camera.intrinsics = intrinsics;
    scene.uncertainty.toy = PoseUncertainty {
        position_m: Some(0.0),
        rotation_rad: Some(0.0),
    };
    input.camera.intrinsics = intrinsics;
    input = input.with_image(enlarged(SESSION.1.image.rgba(), SIDE));
    let mut aligner = Aligner::new(scene);
    let mut shifted = |mm: f64| {
        let mut input = input.clone();
        input.world_from_object = DMat4::from_translation(1e-3 * mm * DVec3::X) * input.world_from_object;
        let found = aligner.align(&input).unwrap();
        let shown_px = found.report.pose.unwrap().shown_px();
        (shown_px > 1.1).then_some((shown_px, found))
    };
    let (shown_px, found) = [0.6, 0.65, 0.7, 0.75, 0.8]
        .into_iter()
        .find_map(&mut shifted)
        .unwrap();
    assert!(shown_px < 1.9, "{shown_px} px");
    let is_off = |warning: &AlignmentWarning| matches!(warning, AlignmentWarning::Misaligned { .. });
    assert!(!found.warnings.iter().any(is_off), "{:?}", found.warnings);
}
