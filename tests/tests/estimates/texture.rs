//! How a ball is turned shows in its dots alone: its outline is the same from all sides.

use app_core::alignment::{Aligner, Alignment};
use glam::{DMat4, DVec3};
use measure::photographer::world::toward;
use measure::photographer::{Part, Shape, Shot, Shown, Stance, World};

const RADIUS_M: f64 = 0.04;
const TURN_DEG: f64 = 4.0;
/// A ball's dots are found to a tenth of a pixel.
const FOUND_DEG: f64 = 0.25;
const BALL: DVec3 = DVec3::new(0.60, 0.35, 0.25);
const DOTS: DVec3 = DVec3::new(0.15, 0.30, 0.45);

fn ball(at_m: DVec3, radius_m: f64, color: DVec3) -> Part {
    Part {
        shape: Shape::Sphere { radius_m },
        color,
        rest: Stance::at(at_m),
        keys: Vec::new(),
    }
}

/// A ball on a table with dots on the side of the camera, or without, given turned about the vertical: how far it is turned as alignment
/// finds it, in degrees.
fn turned_ball(has_dots: bool) -> (f64, Alignment) {
    let mut world = World::boxes().resized([640, 360]);
    let middle_m = DVec3::new(0.0, RADIUS_M, 0.0);
    let places: &[(f64, f64)] = match has_dots {
        true => &[(30.0, -30.0), (5.0, 0.0), (35.0, 40.0), (60.0, 10.0)],
        false => &[],
    };
    let dots = places.iter().map(|(elevation_deg, azimuth_deg)| {
        let out = toward(*elevation_deg, *azimuth_deg);
        ball(middle_m + 0.85 * RADIUS_M * out, 0.22 * RADIUS_M, DOTS)
    });
    world.parts = vec![ball(middle_m, RADIUS_M, BALL)];
    world.parts.extend(dots);
    world.shown = Shown::Rest;
    let Shot { scene, mut input, .. } = Shot::of(&world).unwrap();
    let truth = input.world_from_object;
    input.world_from_object *= DMat4::from_rotation_y(TURN_DEG.to_radians());
    let found = Aligner::new(scene).align(&input).unwrap();
    let turn = truth.inverse() * found.world_from_object;
    let turn_deg = turn
        .to_scale_rotation_translation()
        .1
        .to_scaled_axis()
        .length()
        .to_degrees();
    (turn_deg, found)
}

#[test]
fn a_textured_ball_is_turned_as_its_dots_show() {
    let (turn_deg, found) = turned_ball(true);
    let pose = found.report.pose.unwrap();
    assert!(turn_deg < FOUND_DEG, "{turn_deg} degrees off: {pose:?}");
    assert!(
        pose.is_applied && pose.texture_correlation.unwrap() > 0.9,
        "{pose:?}"
    );
    assert!(
        turn_deg < 2.0 * pose.deviation.rotation_rad.to_degrees(),
        "{turn_deg} degrees off: {pose:?}"
    );
}

#[test]
fn a_ball_of_one_colour_stays_as_it_is_given() {
    let (turn_deg, found) = turned_ball(false);
    let pose = found.report.pose.unwrap();
    assert!(
        (turn_deg - TURN_DEG).abs() < 1.0,
        "{turn_deg} degrees off: {pose:?}"
    );
    assert_eq!(pose.texture_correlation, None);
}
