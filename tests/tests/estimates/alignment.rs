//! Toy and lights are found in the pictures of the bundled session although the given values are
//! off by some millimetres and degrees; correct values stay.

use std::sync::Arc;

use app_core::alignment::{AlignError, Aligner, Alignment, AlignmentWarning, Outlines};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Light, Plate};
use app_scene::geometry::bounds::Bounds;
use glam::{DMat4, DQuat, DVec2, DVec3};
use measure::photographer::{Shot, World};

use super::bundled::SESSION;

/// Largest difference between the pose that is found and the recorded one at the corners of the
/// toy's box: the session was rendered with few samples per pixel.
const RECORDED_PX: f64 = 0.3;
/// Largest difference of poses that are found from different starts, as a share of the standard
/// deviation that is reported for them.
const OF_CLAIMED: f64 = 0.5;
/// Largest difference of a light's directions that are found from different starts.
const SAME_DEG: f64 = 0.02;

fn aligner() -> Aligner {
    Aligner::new(SESSION.0.clone())
}

fn align(input: &FrameInput) -> Alignment {
    aligner().align(input).unwrap()
}

/// The session's first frame, with the toy moved about its centre by millimetres and degrees.
fn disturbed(axis: DVec3, mm: DVec3, deg: f64) -> FrameInput {
    let mut input = SESSION.1.clone();
    let middle = toy_in_world();
    input.world_from_object = DMat4::from_translation(middle + 1e-3 * mm)
        * DMat4::from_axis_angle(axis.normalize(), deg.to_radians())
        * DMat4::from_translation(-middle)
        * input.world_from_object;
    input
}

pub(super) fn corners() -> Vec<DVec3> {
    let (scene, _) = &*SESSION;
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).unwrap();
    let bounds = Bounds {
        min: bounds.min.as_dvec3(),
        max: bounds.max.as_dvec3(),
    };
    bounds.corners().collect()
}

fn toy_in_world() -> DVec3 {
    let middle = corners().iter().sum::<DVec3>() / 8.0;
    SESSION.1.world_from_object.transform_point3(middle)
}

/// The largest distance in the picture between the corners of the toy's box in two poses.
fn apart_px(a: &DMat4, b: &DMat4) -> f64 {
    let camera_from_world = SESSION.1.camera.world_from_camera.inverse();
    corners_apart_px([a, b].map(|world_from_object| camera_from_world * *world_from_object))
}

/// The same for the recorded pose in two cameras.
fn cameras_apart_px(a: &DMat4, b: &DMat4) -> f64 {
    corners_apart_px(
        [a, b].map(|world_from_camera| world_from_camera.inverse() * SESSION.1.world_from_object),
    )
}

fn corners_apart_px([a, b]: [DMat4; 2]) -> f64 {
    let pixel = |camera_from_object: &DMat4, corner: DVec3| {
        let k = &SESSION.1.camera.intrinsics;
        let at = camera_from_object.transform_point3(corner);
        DVec2::new(-k.fx_px * at.x / at.z, k.fy_px * at.y / at.z)
    };
    let distances = corners()
        .into_iter()
        .map(|corner| (pixel(&a, corner) - pixel(&b, corner)).length());
    distances.fold(0.0, f64::max)
}

pub(super) fn turned_light(deg: f64, size: f64) -> Light {
    match SESSION.0.lights[0] {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => {
            let to = position_in_world - toy_in_world();
            let axis = to.cross(DVec3::new(0.3, 0.9, -0.4)).normalize();
            Light::Sphere {
                position_in_world: toy_in_world() + DQuat::from_axis_angle(axis, deg.to_radians()) * to,
                radius_m: size * radius_m,
            }
        }
        Light::Directional { .. } => unreachable!("the bundled session has a bulb"),
    }
}

pub(super) fn direction(light: &Light) -> DVec3 {
    match light {
        Light::Sphere {
            position_in_world, ..
        } => (*position_in_world - toy_in_world()).normalize(),
        Light::Directional { .. } => unreachable!("the bundled session has a bulb"),
    }
}

/// Radius over distance.
fn spread(light: &Light) -> f64 {
    match light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => radius_m / position_in_world.distance(toy_in_world()),
        Light::Directional { .. } => unreachable!("the bundled session has a bulb"),
    }
}

#[test]
fn what_is_right_stays_as_it_is() {
    let (_, input) = &*SESSION;
    let mut aligner = aligner();
    let found = aligner.align(input).unwrap();
    assert_eq!(found.camera, input.camera);
    assert_eq!(aligner.scene().plates[0].camera, SESSION.0.plates[0].camera);
    assert_eq!(found.world_from_object, input.world_from_object);
    assert_eq!(found.lights, None);
    assert!(found.warnings.is_empty());
    let pose = found.report.pose.unwrap();
    assert!(!pose.is_applied && pose.outline_px < 0.2, "{pose:?}");
}

#[test]
fn a_disturbed_pose_comes_back_to_one_place() {
    let starts = [
        disturbed(DVec3::X, DVec3::new(2.0, -3.0, 3.5), 3.0),
        disturbed(DVec3::Y, DVec3::new(-4.0, 1.0, 2.0), -3.0),
        disturbed(DVec3::new(1.0, 1.0, -1.0), DVec3::new(7.0, 5.0, -5.0), 6.0),
    ];
    let found = starts.map(|start| {
        // The pose that is found is not the given one.
        assert!(apart_px(&start.world_from_object, &SESSION.1.world_from_object) > 5.0);
        let found = align(&start);
        let pose = found.report.pose.unwrap();
        assert!(pose.is_applied);
        (found.world_from_object, pose.deviation.lateral_m)
    });
    let depth_m = SESSION
        .1
        .camera
        .world_from_camera
        .w_axis
        .truncate()
        .distance(toy_in_world());
    let px_per_m = SESSION.1.camera.intrinsics.fx_px / depth_m;
    for (pose, lateral_m) in &found {
        let recorded_px = apart_px(pose, &SESSION.1.world_from_object);
        assert!(
            recorded_px < RECORDED_PX,
            "{recorded_px} px from the recorded pose"
        );
        let (apart_px, claimed_px) = (apart_px(pose, &found[0].0), lateral_m * px_per_m);
        assert!(
            apart_px < OF_CLAIMED * claimed_px && claimed_px < 0.3,
            "{apart_px} px apart, {claimed_px} px claimed"
        );
    }
}

#[test]
fn a_disturbed_light_comes_back_to_one_place() {
    let found = [(10.0, 2.0), (-10.0, 0.5)].map(|(deg, size)| {
        let mut input = SESSION.1.clone();
        input.lights = Some(Arc::new([turned_light(deg, size)]));
        let found = align(&input);
        assert!(found.report.lights[0].is_applied);
        found.lights.unwrap()[0]
    });
    let recorded = direction(&SESSION.0.lights[0]);
    for light in &found {
        let deg = direction(light).angle_between(recorded).to_degrees();
        assert!(deg < 0.15, "{deg} degrees from the recorded direction");
        let size = spread(light) / spread(&SESSION.0.lights[0]);
        assert!((size - 1.0).abs() < 0.1, "{size} times the recorded size");
        let deg = direction(light).angle_between(direction(&found[0])).to_degrees();
        assert!(deg < SAME_DEG, "{deg} degrees apart");
    }
}

#[test]
fn a_world_elsewhere_has_the_same_correction() {
    let input = disturbed(DVec3::Z, DVec3::new(1.0, 2.0, -2.0), 2.0);
    let here = align(&input);
    let there_from_here = DMat4::from_rotation_translation(
        DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7),
        DVec3::new(6e3, -3e3, 7e3),
    );
    let mut scene = SESSION.0.clone();
    let mut moved = input.clone();
    moved.camera.world_from_camera = there_from_here * moved.camera.world_from_camera;
    moved.world_from_object = there_from_here * moved.world_from_object;
    for receiver in &mut scene.receivers {
        receiver.world_from_plane = there_from_here * receiver.world_from_plane;
    }
    for plate in &mut scene.plates {
        plate.camera = moved.camera;
    }
    for light in &mut scene.lights {
        if let Light::Sphere {
            position_in_world, ..
        } = light
        {
            *position_in_world = there_from_here.transform_point3(*position_in_world);
        }
    }
    let there = Aligner::new(scene).align(&moved).unwrap();
    let in_camera = |found: &Alignment, input: &FrameInput| {
        (input.camera.world_from_camera.inverse() * found.world_from_object).as_mat4()
    };
    assert!(here.report.pose.unwrap().is_applied && there.report.pose.unwrap().is_applied);
    // Products of matrices of a world 10 km away keep a millionth of a millimetre.
    let (here, there) = (in_camera(&here, &input), in_camera(&there, &moved));
    assert!(here.abs_diff_eq(there, 1e-8), "{here} and {there}");
}

/// A camera moved by millimetres and turned by degrees, as a tracker would report it.
fn shaken(camera: &Camera, mm: DVec3, deg: DVec3) -> Camera {
    let step = DMat4::from_rotation_translation(DQuat::from_scaled_axis(deg.map(f64::to_radians)), 1e-3 * mm);
    Camera {
        world_from_camera: camera.world_from_camera * step,
        ..*camera
    }
}

#[test]
fn a_camera_is_found_by_the_table() {
    let recorded = SESSION.1.camera;
    for (mm, deg) in [
        (DVec3::new(0.1, 0.1, -0.2), DVec3::new(0.02, -0.01, 0.03)),
        (DVec3::new(-1.0, 0.5, 1.0), DVec3::new(0.1, 0.2, -0.1)),
        (DVec3::new(6.0, -6.0, 5.0), DVec3::new(-0.6, 0.7, 0.3)),
    ] {
        let given = SESSION.1.clone().with_camera(shaken(&recorded, mm, deg));
        let found = align(&given);
        assert!(found.report.camera.unwrap().is_applied);
        let apart_px = cameras_apart_px(&found.camera.world_from_camera, &recorded.world_from_camera);
        assert!(apart_px < 0.1, "{mm} mm, {deg} degrees: {apart_px} px off");
    }
}

#[test]
fn plates_are_aligned_to_the_first() {
    let (mut scene, input) = SESSION.clone();
    let shaken = Plate {
        camera: shaken(
            &input.camera,
            DVec3::new(2.0, 0.0, -1.0),
            DVec3::new(0.2, -0.2, 0.1),
        ),
        ..scene.plates[0].clone()
    };
    scene.plates.push(shaken);
    let mut aligner = Aligner::new(scene);
    aligner.align(&input).unwrap();
    let [first, second] = &aligner.scene().plates[..] else {
        panic!("two plates");
    };
    assert_eq!(first.camera, SESSION.0.plates[0].camera);
    let cameras = [first, second].map(|plate| plate.camera.world_from_camera);
    let apart_px = cameras_apart_px(&cameras[0], &cameras[1]);
    assert!(apart_px < 0.02, "{apart_px} px off");
}

#[test]
fn a_plate_of_another_table_moves_no_camera() {
    let (mut scene, input) = SESSION.clone();
    let mut mirrored = Image::clone(&scene.plates[0].image);
    let row_bytes = 4 * mirrored.width_px as usize;
    for row in mirrored.rgba8.chunks_exact_mut(row_bytes) {
        row.as_chunks_mut::<4>().0.reverse();
    }
    scene.plates[0].image = Arc::new(mirrored);
    let found = Aligner::new(scene).align(&input).unwrap();
    assert_eq!(found.camera, input.camera);
}

#[test]
fn what_was_found_is_kept_as_long_as_it_holds() {
    let mut input = SESSION.1.clone();
    input.lights = Some(Arc::new([turned_light(10.0, 2.0)]));
    let mut aligner = aligner();
    let first = aligner.align(&input).unwrap();
    assert!(first.lights.is_some());
    // The lights of another picture of the same view are those that were found before.
    let mut again = input.clone();
    again.image = Image::clone(input.image.rgba()).into();
    let again = aligner.align(&again).unwrap();
    assert_eq!(again.lights, first.lights);
    assert_eq!(again.report.lights, first.report.lights);
    // Other listed lights are not replaced by them; an empty list starts a search.
    let mut other = input.clone();
    other.lights = Some(vec![SESSION.0.lights[0]; 5].into());
    let found = aligner.align(&other).unwrap();
    assert_eq!((found.lights, found.report.lights.len()), (None, 0));
    other.lights = Some(Arc::new([]));
    let found = aligner.align(&other).unwrap();
    assert_eq!((found.report.lights.len(), found.report.discovered.len()), (0, 1));
    // A picture without the toy is not treated like the previous one.
    let mut other = input.clone();
    other.image = Arc::clone(&SESSION.0.plates[0].image).into();
    assert_ne!(aligner.align(&other).unwrap().report, first.report);
}

#[test]
fn a_toy_that_stands_still_is_not_moved_by_its_tracker() {
    let mut aligner = aligner();
    let starts = [
        (DVec3::X, 0.0),
        (DVec3::Y, 0.3),
        (DVec3::Z, 0.6),
        (DVec3::NEG_X, 4.0),
    ];
    let poses: Vec<DMat4> = starts
        .iter()
        .map(|(along, mm)| {
            let mut input = disturbed(*along, *mm * DVec3::ONE, *mm);
            // For all that the aligner knows, this is another picture.
            input.image = Image::clone(input.image.rgba()).into();
            aligner.align(&input).unwrap().world_from_object
        })
        .collect();
    assert!(poses.iter().all(|pose| *pose == poses[0]), "{poses:?}");
}

/// Boxes on a table, photographed twice; the tracker does not know that they were pushed in
/// between.
#[test]
fn a_toy_that_was_nudged_is_found_in_the_next_picture() {
    let before = World::boxes().resized([320, 180]);
    let middle = before.world_from_object.w_axis.truncate();
    let nudge = DMat4::from_translation(middle + DVec3::new(0.004, 0.0, -0.003))
        * DMat4::from_rotation_y(4f64.to_radians())
        * DMat4::from_translation(-middle);
    let after = World {
        world_from_object: nudge * before.world_from_object,
        ..before.clone()
    };
    let [before, after] = [before, after].map(|world| Shot::of(&world).unwrap());
    let mut aligner = Aligner::new(before.scene.clone());
    assert!(
        !aligner
            .align(&before.input)
            .unwrap()
            .report
            .pose
            .unwrap()
            .is_applied
    );
    let unaware = after
        .input
        .clone()
        .with_world_from_object(before.input.world_from_object);
    let found = aligner.align(&unaware).unwrap();
    let pose = found.report.pose.unwrap();
    assert!(pose.is_applied && !pose.is_held, "{pose:?}");
    let off_m = [DVec3::ZERO, DVec3::new(0.05, 0.1, 0.05)].map(|at| {
        let [found, there] = [found.world_from_object, after.input.world_from_object]
            .map(|world_from_object| world_from_object.transform_point3(at));
        found.distance(there)
    });
    // The far corner was pushed by 12 mm; with four rays per pixel, 1.2 mm wide, the measured error
    // is 1 mm, along the line of sight.
    assert!(off_m.iter().all(|off_m| *off_m < 1.5e-3), "{off_m:?} m off");
}

#[test]
fn a_shadow_is_cast_from_the_middle_of_its_light() {
    let outlines = |radius: f64| {
        let mut input = SESSION.1.clone();
        input.lights = Some(Arc::new([turned_light(0.0, radius)]));
        Outlines::of(&SESSION.0, &input).unwrap()
    };
    let (small, large) = (outlines(0.0), outlines(5.0));
    assert!(small.shadows[0].len() > 100 && small.toy.len() > 100);
    assert_eq!(small.shadows, large.shadows);
}

#[test]
fn without_a_plate_the_pose_is_found_and_lights_stay() {
    let mut scene = SESSION.0.clone();
    scene.plates.clear();
    let start = disturbed(DVec3::Y, DVec3::new(3.0, -2.0, 2.0), 3.0);
    let found = Aligner::new(scene).align(&start).unwrap();
    let apart_px = apart_px(&found.world_from_object, &SESSION.1.world_from_object);
    assert!(apart_px < 1.0, "{apart_px} px from the recorded pose");
    assert_eq!((found.lights, found.report.lights.len()), (None, 0));
}

#[test]
fn a_toy_that_is_not_in_the_picture_is_not_found_there() {
    let mut input = SESSION.1.clone();
    input.image = Arc::clone(&SESSION.0.plates[0].image).into();
    let found = align(&input);
    assert_eq!(found.world_from_object, input.world_from_object);
    assert!(found.report.lights.is_empty());
    assert!(
        matches!(found.warnings[..], [AlignmentWarning::Misaligned { .. }]),
        "{:?}",
        found.report
    );
}

#[test]
fn nonsense_is_neither_found_nor_a_panic() {
    let camera = SESSION.1.camera.world_from_camera.w_axis.truncate();
    let behind = 2.0 * (camera - toy_in_world());
    for (mm, scale) in [
        (DVec3::new(0.0, 300.0, 0.0), 1.0),
        // Around the camera, behind it, and as large as a house.
        (1e3 * (camera - toy_in_world()), 1.0),
        (1e3 * behind, 1.0),
        (DVec3::ZERO, 100.0),
        (DVec3::ZERO, 1e-4),
    ] {
        let mut input = disturbed(DVec3::Y, mm, 40.0);
        input.world_from_object *= DMat4::from_scale(DVec3::splat(scale));
        let given = input.world_from_object;
        let found = align(&input);
        assert_eq!(
            found.world_from_object, given,
            "moved by {mm} mm, scaled by {scale}"
        );
        assert!(found.lights.is_none());
    }
}

#[test]
fn pictures_of_another_size_are_refused() {
    let mut input = SESSION.1.clone();
    input.image = app_core::camera_frame::CameraImage::from(Image {
        width_px: 2,
        height_px: 2,
        rgba8: vec![255; 16],
    });
    let refused = aligner().align(&input).unwrap_err();
    assert!(matches!(refused, AlignError::Size { .. }), "{refused}");
    assert!(refused.to_string().contains("camera frame"), "{refused}");
}

/// A ghost that a hand drops on the table: turned farther than the outline's coarse rounds search,
/// but upright. A ghost that floats above the table is not searched, and is not reported as found.
#[test]
fn a_ghost_dropped_on_the_plane_is_found_upright() {
    let recorded = &SESSION.1.world_from_object;
    for (mm, deg) in [
        (DVec3::new(15.0, 0.0, 0.0), 60.0),
        (DVec3::new(-10.0, 0.0, -12.0), -70.0),
    ] {
        let dropped = align(&disturbed(DVec3::Y, mm, deg));
        // Measured: .27.
        let apart = apart_px(&dropped.world_from_object, recorded);
        assert!(apart < 0.4, "{deg} degrees: {apart} px");
        let floating = align(&disturbed(DVec3::Y, mm + 30.0 * DVec3::Y, deg));
        assert!(apart_px(&floating.world_from_object, recorded) > 50.0);
        assert!(!floating.report.pose.unwrap().is_applied);
    }
}
