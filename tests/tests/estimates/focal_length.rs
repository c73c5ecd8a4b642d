//! The focal length of the bundled session is found by toy and shadow, whatever else is off; a
//! correct one stays.

use std::sync::Arc;

use app_core::alignment::{Aligner, Alignment, RatioOutcome};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Light, Scene};
use app_core::session::GroundTruth;
use glam::{DMat4, DQuat, DVec3};

use harness::bundled_session;

use super::bundled::{SESSION, middle};
use super::model::wavy;

/// Largest error of the ratio that is found: the session was rendered with few samples per pixel.
const RATIO: f64 = 6e-4;

fn lengthened(camera: &Camera, ratio: f64) -> Camera {
    let mut camera = *camera;
    camera.intrinsics.fx_px *= ratio;
    camera.intrinsics.fy_px *= ratio;
    camera
}

/// The session with a wrong focal length in plates and frame.
fn off(ratio: f64) -> (Scene, FrameInput) {
    let (mut scene, mut input) = SESSION.clone();
    for plate in &mut scene.plates {
        plate.camera = lengthened(&plate.camera, ratio);
    }
    input.camera = lengthened(&input.camera, ratio);
    (scene, input)
}

/// Toy and light are wrong as well: by 5 mm and 3 degrees, by 10 degrees and twice the size.
fn disturbed(input: &FrameInput) -> FrameInput {
    let at = middle(&input.world_from_object);
    let Light::Sphere {
        position_in_world,
        radius_m,
    } = SESSION.0.lights[0]
    else {
        unreachable!("the bundled session has a bulb");
    };
    let to = position_in_world - at;
    let axis = to.cross(DVec3::new(0.3, 0.9, -0.4)).normalize();
    input
        .clone()
        .with_world_from_object(
            DMat4::from_translation(at + DVec3::new(2e-3, -3e-3, 3.5e-3))
                * DMat4::from_rotation_x(3f64.to_radians())
                * DMat4::from_translation(-at)
                * input.world_from_object,
        )
        .with_lights(Some(Arc::new([Light::Sphere {
            position_in_world: at + DQuat::from_axis_angle(axis, 10f64.to_radians()) * to,
            radius_m: 2.0 * radius_m,
        }])))
}

fn off_mm(found: &Alignment) -> f64 {
    let recorded = &SESSION.1.world_from_object;
    1e3 * middle(&found.world_from_object).distance(middle(recorded))
}

#[test]
fn a_focal_length_that_is_off_is_found() {
    for ratio in [0.99, 1.01] {
        let (scene, input) = off(ratio);
        for input in [input.clone(), disturbed(&input)] {
            let mut aligner = Aligner::new(scene.clone()).with_unknown_focal_length();
            let found = aligner.align(&input).unwrap();
            let report = found.report.focal_length.unwrap();
            assert_eq!(report.outcome, RatioOutcome::Corrected, "{report:?}");
            assert!((ratio * report.ratio - 1.0).abs() < RATIO, "{ratio}: {report:?}");
            assert!(off_mm(&found) < 0.5, "{} mm off", off_mm(&found));
            // The result contains it for the frame and for the plates.
            let corrected = lengthened(&input.camera, report.ratio).intrinsics;
            assert_eq!(found.applied_to(&input).camera.intrinsics, corrected);
            assert_eq!(aligner.scene().plates[0].camera.intrinsics, corrected);
        }
    }
}

/// Control for the test above: without a request, the toy is found on its table in another size.
#[test]
fn a_focal_length_that_nobody_asks_for_stays() {
    let (scene, input) = off(1.01);
    let input = disturbed(&input);
    let mut aligner = Aligner::new(scene);
    let found = aligner.align(&input).unwrap();
    assert_eq!(found.report.focal_length, None);
    assert_eq!(found.camera.intrinsics, input.camera.intrinsics);
    assert_eq!(
        aligner.scene().plates[0].camera.intrinsics,
        input.camera.intrinsics
    );
    assert!(off_mm(&found) > 0.8, "{} mm off", off_mm(&found));
}

#[test]
fn a_focal_length_that_is_right_changes_nothing() {
    let (scene, input) = SESSION.clone();
    let found = Aligner::new(scene.clone())
        .with_unknown_focal_length()
        .align(&input)
        .unwrap();
    let without = Aligner::new(scene).align(&input).unwrap();
    let report = found.report.focal_length.unwrap();
    assert_eq!(report.outcome, RatioOutcome::AsGiven, "{report:?}");
    assert!(report.deviation < 2e-3, "{report:?}");
    assert_eq!(
        (found.camera, found.world_from_object, &found.lights),
        (without.camera, without.world_from_object, &without.lights)
    );
}

#[test]
fn it_is_found_once_and_kept() {
    let (scene, input) = off(1.01);
    let mut aligner = Aligner::new(scene).with_unknown_focal_length();
    // A view without the toy does not constrain it, and does not end the search.
    let empty = input.clone().with_image(Arc::clone(&SESSION.0.plates[0].image));
    let unseen = aligner.align(&empty).unwrap();
    let outcome = unseen.report.focal_length.unwrap().outcome;
    assert_eq!(outcome, RatioOutcome::Unseen);
    assert_eq!(unseen.camera, input.camera);
    let first = aligner.align(&input).unwrap();
    let ratio = first.report.focal_length.unwrap().ratio;
    assert!((1.01 * ratio - 1.0).abs() < RATIO, "{ratio}");
    // Another picture, by a camera that zoomed: the same ratio to the given focal length.
    let image = Image::clone(input.image.rgba());
    let camera = lengthened(&input.camera, 1.002);
    let zoomed = input.with_image(image).with_camera(camera);
    let second = aligner.align(&zoomed).unwrap();
    assert_eq!(second.report.focal_length, first.report.focal_length);
    assert_eq!(
        second.camera.intrinsics,
        lengthened(&zoomed.camera, ratio).intrinsics
    );
}

/// Both move the shadow's foot like another focal length; the outline resolves it.
#[test]
fn a_lower_table_and_a_larger_toy_are_no_focal_length() {
    let (mut lower, input) = SESSION.clone();
    for receiver in &mut lower.receivers {
        receiver.world_from_plane = DMat4::from_translation(-2e-3 * DVec3::Y) * receiver.world_from_plane;
    }
    let larger = input
        .clone()
        .with_world_from_object(input.world_from_object * DMat4::from_scale(DVec3::splat(1.02)));
    for (scene, input) in [(lower, input), (SESSION.0.clone(), larger)] {
        let mut aligner = Aligner::new(scene).with_unknown_focal_length();
        let found = aligner.align(&input).unwrap();
        let report = found.report.focal_length.unwrap();
        assert_eq!(report.outcome, RatioOutcome::OutlineDisagrees, "{report:?}");
        assert_eq!(found.camera.intrinsics, input.camera.intrinsics);
    }
}

#[test]
fn what_cannot_tell_it_leaves_it() {
    let (mut scene, input) = off(1.01);
    scene.plates.clear();
    let found = Aligner::new(scene)
        .with_unknown_focal_length()
        .align(&input)
        .unwrap();
    let report = found.report.focal_length.unwrap();
    assert_eq!(report.outcome, RatioOutcome::Unseen);
    assert_eq!(found.camera.intrinsics, input.camera.intrinsics);
}

/// A view without a shadow shows the toy, and so adapts its model, though nothing tells the focal length. What it told
/// is forgotten once the length is found: all is then as if the later view were the first.
#[test]
fn what_was_told_before_it_was_found_is_forgotten() {
    let (scene, input) = off(1.01);
    let scene = scene.with_toy(wavy(1.0).toy);
    let plate = Arc::clone(&scene.plates[0].image);
    let labels = bundled_session().truth(0).unwrap().unwrap().mask;
    let mut unlit = Image::clone(&plate);
    for at in (0..labels.rgba8.len())
        .step_by(4)
        .filter(|at| labels.rgba8[at + 1] > 0)
    {
        unlit.rgba8[at..at + 3].copy_from_slice(&input.image.rgba().rgba8[at..at + 3]);
    }
    let mut aligner = Aligner::new(scene.clone()).with_unknown_focal_length();
    let first = aligner.align(&input.clone().with_image(unlit)).unwrap();
    assert!(first.report.model.is_some(), "{:?}", first.report);
    assert!(
        !first.report.focal_length.unwrap().is_applied(),
        "{:?}",
        first.report
    );
    let second = aligner.align(&input).unwrap();
    assert!(
        second.report.focal_length.unwrap().is_applied(),
        "{:?}",
        second.report
    );
    let alone = Aligner::new(scene)
        .with_unknown_focal_length()
        .align(&input)
        .unwrap();
    assert_eq!(second.report, alone.report);
}
