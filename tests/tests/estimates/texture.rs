//! The turn of a can is visible in its dots alone: its outline is the same from all sides.

use app_core::alignment::{Aligner, Alignment};
use glam::{DMat4, DVec2, DVec3};
use measure::photographer::{Part, Shape, Shot, Shown, Stance, World};

const RADIUS_M: f64 = 0.03;
const HALF_HEIGHT_M: f64 = 0.045;
const N_SIDES: u32 = 48;
const TURN_DEG: f64 = 4.0;
/// A quarter of a pixel at the can's front.
const FOUND_DEG: f64 = 0.25;
const CAN: DVec3 = DVec3::new(0.10, 0.16, 0.30);
const DOTS: DVec3 = DVec3::new(0.70, 0.60, 0.40);
/// Heights in metres and azimuths in degrees; the camera looks from azimuth 10.
const PLACES: [(f64, f64); 4] = [(0.02, -25.0), (0.045, 10.0), (0.07, 45.0), (0.06, -15.0)];

fn part(shape: Shape, at_m: DVec3, color: DVec3) -> Part {
    Part {
        shape,
        color,
        rest: Stance::at(at_m),
        keys: Vec::new(),
    }
}

fn can() -> Part {
    let corner = |side: u32| DVec2::from_angle(f64::from(side) * std::f64::consts::TAU / f64::from(N_SIDES));
    let outline_m: Vec<DVec2> = (0..N_SIDES).map(|side| RADIUS_M * corner(side)).collect();
    part(
        Shape::prism(&outline_m, HALF_HEIGHT_M),
        DVec3::new(0.0, HALF_HEIGHT_M, 0.0),
        CAN,
    )
}

/// A flat dot on the can.
fn dot((height_m, azimuth_deg): (f64, f64)) -> Part {
    let (x, z) = f64::to_radians(azimuth_deg).sin_cos();
    let radius_m = 0.3 * RADIUS_M;
    let at_m = DVec3::new(0.8 * RADIUS_M * x, height_m, 0.8 * RADIUS_M * z);
    part(Shape::Sphere { radius_m }, at_m, DOTS)
}

/// A can on a table, with dots on the side of the camera or without, given turned about the vertical: how far it is turned as
/// alignment finds it, in degrees.
fn turned_can(has_dots: bool) -> (f64, Alignment) {
    let mut world = World::boxes().resized([640, 360]);
    world.parts = vec![can()];
    if has_dots {
        world.parts.extend(PLACES.map(dot));
    }
    world.shown = Shown::Rest;
    let Shot { scene, mut input, .. } = Shot::of(&world).unwrap();
    let truth = input.world_from_object;
    input.world_from_object *= DMat4::from_rotation_y(TURN_DEG.to_radians());
    let found = Aligner::new(scene).align(&input).unwrap();
    let turn = truth.inverse() * found.world_from_object;
    let turn = turn.to_scale_rotation_translation().1.to_scaled_axis();
    (turn.length().to_degrees(), found)
}

#[test]
fn a_can_is_turned_as_its_dots_show() {
    let (turn_deg, found) = turned_can(true);
    let pose = found.report.pose.unwrap();
    assert!(turn_deg < FOUND_DEG, "{turn_deg} degrees off: {pose:?}");
    assert!(
        pose.is_applied && pose.texture_correlation.unwrap() > 0.9,
        "{pose:?}"
    );
    let deviation_deg = pose.deviation.rotation_rad.to_degrees();
    assert!(turn_deg < 2.0 * deviation_deg, "{turn_deg} degrees off: {pose:?}");
}

#[test]
fn a_can_without_dots_stays_as_it_is_given() {
    let (turn_deg, found) = turned_can(false);
    let pose = found.report.pose.unwrap();
    assert!(
        (turn_deg - TURN_DEG).abs() < 1.0,
        "{turn_deg} degrees off: {pose:?}"
    );
    assert_eq!(pose.texture_correlation, None, "{pose:?}");
}
