//! The scale of the world is found by the toy's size and its shadow; a correct one stays.

use std::sync::Arc;

use app_core::alignment::{Aligner, Alignment, AlignmentWarning, RatioOutcome};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Light, Scene};
use glam::{DMat4, DQuat, DVec3};

use super::bundled::{SESSION, middle};

/// Largest error of the ratio that is found: the session was rendered with few samples per pixel.
const RATIO: f64 = 1e-3;
/// Poses are stored in 32 bits.
const ROUNDING: f64 = 1e-6;

/// A rigid transform in a world with larger lengths.
fn stretched(rigid: &DMat4, ratio: f64) -> DMat4 {
    let mut rigid = *rigid;
    rigid.w_axis = (ratio * rigid.w_axis.truncate()).extend(1.0);
    rigid
}

fn seen_from(camera: &Camera, ratio: f64) -> Camera {
    Camera {
        world_from_camera: stretched(&camera.world_from_camera, ratio),
        ..*camera
    }
}

/// The session of a tracker with a wrong metre: the toy stands at its place on the table, and has
/// its model's size.
fn off(ratio: f64) -> (Scene, FrameInput) {
    let (mut scene, mut input) = SESSION.clone();
    for plate in &mut scene.plates {
        plate.camera = seen_from(&plate.camera, ratio);
    }
    for receiver in &mut scene.receivers {
        receiver.world_from_plane = stretched(&receiver.world_from_plane, ratio);
        receiver.half_extent_m *= ratio;
    }
    input.camera = seen_from(&input.camera, ratio);
    input.world_from_object = stretched(&input.world_from_object, ratio);
    let Light::Sphere {
        position_in_world,
        radius_m,
    } = scene.lights[0]
    else {
        unreachable!("the bundled session has a bulb");
    };
    scene.lights = vec![Light::Sphere {
        position_in_world: ratio * position_in_world,
        radius_m: ratio * radius_m,
    }];
    (scene, input)
}

/// The toy is wrong by 4 mm and 2 degrees, the light by 8 degrees.
fn disturbed(scene: &Scene, input: &FrameInput) -> FrameInput {
    let at = middle(&input.world_from_object);
    let Light::Sphere {
        position_in_world,
        radius_m,
    } = scene.lights[0]
    else {
        unreachable!("the bundled session has a bulb");
    };
    let to = position_in_world - at;
    let axis = to.cross(DVec3::new(0.3, 0.9, -0.4)).normalize();
    input
        .clone()
        .with_world_from_object(
            DMat4::from_translation(at + DVec3::new(2e-3, -2e-3, 3e-3))
                * DMat4::from_rotation_x(2f64.to_radians())
                * DMat4::from_translation(-at)
                * input.world_from_object,
        )
        .with_lights(Some(Arc::new([Light::Sphere {
            position_in_world: at + DQuat::from_axis_angle(axis, 8f64.to_radians()) * to,
            radius_m,
        }])))
}

/// Distance of the toy from its true place, in millimetres of the true world.
fn off_mm(found: &Alignment, ratio: f64) -> f64 {
    let recorded = middle(&SESSION.1.world_from_object);
    1e3 * (middle(&found.world_from_object) / ratio).distance(recorded)
}

#[test]
fn a_scale_that_is_off_is_found() {
    for ratio in [0.97, 1.03] {
        let (scene, input) = off(ratio);
        for input in [input.clone(), disturbed(&scene, &input)] {
            let mut aligner = Aligner::new(scene.clone()).with_unknown_world_scale();
            let found = aligner.align(&input).unwrap();
            let report = found.report.world_scale.unwrap();
            assert_eq!(report.outcome, RatioOutcome::Corrected, "{report:?}");
            assert!((report.ratio / ratio - 1.0).abs() < RATIO, "{ratio}: {report:?}");
            let (scale, ..) = found.world_from_object.to_scale_rotation_translation();
            let (given, ..) = input.world_from_object.to_scale_rotation_translation();
            assert!((scale.x / given.x / report.ratio - 1.0).abs() < ROUNDING);
            assert!(off_mm(&found, ratio) < 0.7, "{} mm off", off_mm(&found, ratio));
            assert_eq!(found.camera, input.camera);
            assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        }
    }
}

/// Without a request the world stays: a toy that stands in it is found in its size there, a
/// floating one farther away or nearer.
#[test]
fn a_scale_that_nobody_asks_for_is_a_size_of_the_toy() {
    let (scene, input) = off(1.03);
    let found = Aligner::new(scene.clone()).align(&input).unwrap();
    assert_eq!(found.report.world_scale, None);
    let pose = found.report.pose.unwrap();
    assert!((pose.size_ratio / 1.03 - 1.0).abs() < RATIO, "{pose:?}");
    assert!(off_mm(&found, 1.03) < 0.2, "{} mm off", off_mm(&found, 1.03));

    let floating = Aligner::new(scene.with_resting(Some(false)))
        .align(&input)
        .unwrap();
    assert!(
        off_mm(&floating, 1.03) > 1.5,
        "{} mm off",
        off_mm(&floating, 1.03)
    );
}

#[test]
fn a_scale_that_is_right_changes_nothing() {
    let (scene, input) = SESSION.clone();
    let found = Aligner::new(scene.clone())
        .with_unknown_world_scale()
        .align(&input)
        .unwrap();
    let without = Aligner::new(scene).align(&input).unwrap();
    let report = found.report.world_scale.unwrap();
    assert_eq!(report.outcome, RatioOutcome::AsGiven, "{report:?}");
    assert_eq!(
        (found.world_from_object, &found.lights),
        (without.world_from_object, &without.lights)
    );
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
}

/// Without a plate no shadow is measured; that is reported, and the world's scale stays.
#[test]
fn what_cannot_tell_it_is_said() {
    let (mut scene, input) = off(1.03);
    scene.plates.clear();
    let found = Aligner::new(scene)
        .with_unknown_world_scale()
        .align(&input)
        .unwrap();
    let report = found.report.world_scale.unwrap();
    assert_eq!(report.outcome, RatioOutcome::Unseen);
    assert!(
        found
            .warnings
            .contains(&AlignmentWarning::WorldScaleUnconstrained)
    );
    let (scale, ..) = found.world_from_object.to_scale_rotation_translation();
    let (given, ..) = input.world_from_object.to_scale_rotation_translation();
    let size_ratio = found.report.pose.unwrap().size_ratio;
    assert!((scale.x / given.x / size_ratio - 1.0).abs() < ROUNDING);
}
