//! The stated uncertainty of a session's toy, camera and lights limits alignment's corrections and
//! determines its search range.

use app_core::alignment::{Aligner, Alignment, AlignmentWarning};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Light, LightUncertainty, PoseUncertainty, Uncertainty};
use glam::{DMat4, DQuat, DVec3};

use super::bundled::{SESSION, middle};

/// Amount that rounding may add to a bound.
const ROUNDING: f64 = 1e-5;
/// Difference between directions from the centre of the box along the camera's axes and along the
/// toy's own.
const MIDDLE_DEG: f64 = 0.1;

fn align(uncertainty: Uncertainty, input: &FrameInput) -> Alignment {
    let scene = SESSION.0.clone().with_uncertainty(uncertainty);
    Aligner::new(scene).align(input).unwrap()
}

fn pose(position_m: f64, rotation_deg: f64) -> PoseUncertainty {
    PoseUncertainty {
        position_m: Some(position_m),
        rotation_rad: Some(rotation_deg.to_radians()),
    }
}

fn of_toy(position_m: f64, rotation_deg: f64) -> Uncertainty {
    Uncertainty {
        toy: pose(position_m, rotation_deg),
        ..Uncertainty::default()
    }
}

fn of_lights(direction_deg: f64) -> Uncertainty {
    Uncertainty {
        lights: LightUncertainty {
            direction_rad: Some(direction_deg.to_radians()),
            ..LightUncertainty::default()
        },
        ..Uncertainty::default()
    }
}

fn middle_in_world() -> DVec3 {
    middle(&SESSION.1.world_from_object)
}

/// The first frame with the toy moved by metres, and turned about its centre by degrees.
fn disturbed(by_m: DVec3, axis: DVec3, deg: f64) -> FrameInput {
    let middle = middle_in_world();
    let mut input = SESSION.1.clone();
    input.world_from_object = DMat4::from_translation(middle + by_m)
        * DMat4::from_axis_angle(axis.normalize(), deg.to_radians())
        * DMat4::from_translation(-middle)
        * input.world_from_object;
    input
}

/// Difference between two poses of the toy: metres at its centre, and degrees.
fn apart(a: &DMat4, b: &DMat4) -> (f64, f64) {
    let [at_a, at_b] = [a, b].map(middle);
    (at_a.distance(at_b), turned_deg(a, b))
}

fn turned_deg(a: &DMat4, b: &DMat4) -> f64 {
    let [a, b] = [a, b].map(|pose| pose.to_scale_rotation_translation().1);
    (b * a.inverse()).to_scaled_axis().length().to_degrees()
}

fn turned_light(deg: f64) -> Light {
    let Light::Sphere {
        position_in_world,
        radius_m,
    } = SESSION.0.lights[0]
    else {
        unreachable!("the bundled session has a bulb")
    };
    let middle = middle_in_world();
    let to = position_in_world - middle;
    let axis = to.cross(DVec3::new(0.3, 0.9, -0.4)).normalize();
    Light::Sphere {
        position_in_world: middle + DQuat::from_axis_angle(axis, deg.to_radians()) * to,
        radius_m,
    }
}

fn light_deg(a: &Light, b: &Light) -> f64 {
    let [a, b] = [a, b].map(|light| match light {
        Light::Sphere {
            position_in_world, ..
        } => *position_in_world - middle_in_world(),
        Light::Directional { .. } => unreachable!("the bundled session has a bulb"),
    });
    a.angle_between(b).to_degrees()
}

#[test]
fn a_toy_is_moved_no_farther_than_its_pose_is_uncertain() {
    let given = disturbed(DVec3::new(0.004, 0.001, -0.003), DVec3::new(1.0, 2.0, -0.5), 3.0);
    let [most_m, most_deg] = [0.001, 0.5];
    let found = align(of_toy(most_m, most_deg), &given);
    let (moved_m, deg) = apart(&given.world_from_object, &found.world_from_object);
    assert!(
        moved_m <= most_m * (1.0 + ROUNDING) && deg <= most_deg * (1.0 + ROUNDING),
        "{moved_m} m, {deg} degrees"
    );
    let warned = found.warnings.iter();
    let misaligned = warned.filter(|warning| matches!(warning, AlignmentWarning::Misaligned { .. }));
    assert_eq!(misaligned.count(), 1, "{:?}", found.warnings);
    // The stated uncertainty is the bound: the toy is found without one, and if it lies within.
    for uncertainty in [Uncertainty::default(), of_toy(0.006, 4.0)] {
        let found = align(uncertainty, &given);
        let (off_m, off_deg) = apart(&SESSION.1.world_from_object, &found.world_from_object);
        assert!(off_m < 2e-4 && off_deg < 0.2, "{off_m} m, {off_deg} degrees");
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    }
}

#[test]
fn what_is_known_is_held() {
    let mut given = disturbed(DVec3::new(0.0, 0.0, 0.002), DVec3::Y, 2.0);
    let light = turned_light(5.0);
    given.lights = Some([light].into());
    given.camera.world_from_camera *= DMat4::from_rotation_y(0.01);
    let known = Uncertainty {
        toy: pose(0.0, 0.0),
        camera: pose(0.0, 0.0),
        ..of_lights(0.0)
    };
    let found = align(known, &given);
    assert_eq!(found.world_from_object, given.world_from_object);
    assert_eq!(found.camera, given.camera);
    if let Some(lights) = &found.lights {
        // Distance and size are not stated to be known.
        assert!(light_deg(&lights[0], &light) < MIDDLE_DEG);
    }
}

#[test]
fn a_toy_that_may_be_anywhere_on_its_table_is_looked_for_there() {
    let given = disturbed(DVec3::new(-0.05, 0.0, 0.01), DVec3::Y, -110.0);
    let by_itself = align(Uncertainty::default(), &given);
    let (off_m, _) = apart(&SESSION.1.world_from_object, &by_itself.world_from_object);
    assert!(
        off_m > 0.005,
        "it is near enough to be found by itself: {off_m} m"
    );
    let found = align(of_toy(0.07, 180.0), &given);
    let (off_m, off_deg) = apart(&SESSION.1.world_from_object, &found.world_from_object);
    assert!(off_m < 3e-4 && off_deg < 0.3, "{off_m} m, {off_deg} degrees off");
}

#[test]
fn a_light_is_turned_no_farther_than_its_direction_is_uncertain() {
    let mut given = SESSION.1.clone();
    let off = turned_light(4.0);
    given.lights = Some([off].into());
    let bounded = align(of_lights(3.2), &given).lights.unwrap();
    let deg = light_deg(&bounded[0], &off);
    assert!(deg > 2.8 && deg <= 3.2 + MIDDLE_DEG, "{deg} degrees");
    for uncertainty in [Uncertainty::default(), of_lights(5.0)] {
        let found = align(uncertainty, &given).lights.unwrap();
        assert!(light_deg(&found[0], &SESSION.0.lights[0]) < 0.1);
    }
}

/// Lights on the bound that leave much of the shadow unexplained are a compromise.
#[test]
fn a_bounded_list_that_explains_too_little_stays() {
    let mut given = SESSION.1.clone();
    given.lights = Some([turned_light(12.0)].into());
    let found = align(of_lights(4.0), &given);
    assert_eq!(found.lights, None, "{:?}", found.report);
    assert!(
        matches!(found.warnings[..], [AlignmentWarning::ListUnexplained { .. }]),
        "{:?}",
        found.warnings
    );
}

#[test]
fn a_light_that_may_be_far_off_is_looked_for_there() {
    let mut given = SESSION.1.clone();
    given.lights = Some([turned_light(40.0)].into());
    let off_deg = |uncertainty| {
        let found = align(uncertainty, &given).lights;
        found.map_or(40.0, |lights| light_deg(&lights[0], &SESSION.0.lights[0]))
    };
    // The search starts by itself, too, since no light near the list explains the shadow; but not
    // if the list is stated to be right.
    for uncertainty in [Uncertainty::default(), of_lights(45.0)] {
        let found_deg = off_deg(uncertainty);
        assert!(found_deg < 0.1, "{found_deg} degrees off");
    }
    assert!(off_deg(of_lights(5.0)) > 30.0, "it is found beyond its bounds");
}

#[test]
fn a_camera_is_moved_no_farther_than_its_pose_is_uncertain() {
    let step = DMat4::from_rotation_translation(
        DQuat::from_scaled_axis(DVec3::new(-0.6, 0.7, 0.3).map(f64::to_radians)),
        DVec3::new(0.006, -0.006, 0.005),
    );
    let given = SESSION.1.clone().with_camera(Camera {
        world_from_camera: SESSION.1.camera.world_from_camera * step,
        ..SESSION.1.camera
    });
    let moved = |camera: PoseUncertainty| {
        let uncertainty = Uncertainty {
            camera,
            ..Uncertainty::default()
        };
        let [a, b] = [&given.camera, &align(uncertainty, &given).camera].map(|one| one.world_from_camera);
        (
            a.w_axis.truncate().distance(b.w_axis.truncate()),
            turned_deg(&a, &b),
        )
    };
    let (by_itself_m, by_itself_deg) = moved(PoseUncertainty::default());
    assert!(by_itself_m > 0.009 && by_itself_deg > 0.9);
    assert_eq!(moved(pose(0.02, 2.0)), (by_itself_m, by_itself_deg));
    let (moved_m, deg) = moved(pose(0.002, 0.4));
    assert!(
        moved_m <= 0.002 * (1.0 + ROUNDING) && deg <= 0.4 * (1.0 + ROUNDING),
        "{moved_m} m, {deg} degrees"
    );
}
