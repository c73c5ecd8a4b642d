//! The lit side of a box, which the shadow crosses, is found below its top, whether that is found or
//! listed.

use app_core::alignment::Observer;
use app_core::scene::Receiver;
use glam::{DMat4, DQuat, DVec2, DVec3};

use super::planes::{HALF_M, session};

/// Height of the box in metres.
const HEIGHT_M: f64 = 0.03;
/// Tolerance of a side's middle and half sides, in metres: two pixels. It begins at the edge of the
/// top, which is found to one and a half.
const WITHIN_M: f64 = 0.003;
/// Smallest cosine between the normals of a found and a true side: three degrees.
const ALONG: f64 = 0.9986;

/// The top of a box whose lit side faces the toy, the light and the camera.
fn top() -> DMat4 {
    DMat4::from_rotation_translation(DQuat::from_rotation_y(-0.4), DVec3::new(-0.1, HEIGHT_M, 0.0))
}

/// All of its sides.
fn sides() -> [(DMat4, DVec2); 4] {
    [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(|outward| side(top(), outward))
}

/// A side of the box that faces `outward` in the space of its top: a rectangle from its edge down to
/// the table.
fn side(top: DMat4, outward: DVec3) -> (DMat4, DVec2) {
    let turn = DQuat::from_rotation_arc(DVec3::Y, outward);
    let middle = outward * DVec3::new(HALF_M.x, 0.0, HALF_M.y) - 0.5 * HEIGHT_M * DVec3::Y;
    let half_m = if outward.x == 0.0 {
        DVec2::new(HALF_M.x, 0.5 * HEIGHT_M)
    } else {
        DVec2::new(0.5 * HEIGHT_M, HALF_M.y)
    };
    (top * DMat4::from_rotation_translation(turn, middle), half_m)
}

/// Whether a receiver is this side: the turn about its normal does not count.
fn is_side(found: &Receiver, (world_from_side, half_m): &(DMat4, DVec2)) -> bool {
    let normals = [found.world_from_plane, *world_from_side].map(|pose| pose.y_axis.truncate());
    let middles = [found.world_from_plane, *world_from_side].map(|pose| pose.w_axis.truncate());
    let sorted =
        [found.half_extent_m, *half_m].map(|half| DVec2::new(half.min_element(), half.max_element()));
    normals[0].dot(normals[1]) > ALONG
        && middles[0].distance(middles[1]) < WITHIN_M
        && (sorted[0] - sorted[1]).abs().max_element() < WITHIN_M
}

#[test]
fn the_side_that_the_shadow_crosses_is_found() {
    let sides = sides();
    let all: Vec<_> = [(top(), HALF_M)].into_iter().chain(sides).collect();
    let (scene, shot) = session(&all);
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    let planes = observer.planes();
    // No light falls on the other side that the camera sees, so the shadow does not tell of it.
    assert_eq!(planes.len(), 2, "{planes:?}");
    let known = observer.scene(&scene);
    assert!(
        known.receivers[1..].iter().any(|found| is_side(found, &sides[0])),
        "{:?}",
        known.receivers
    );
}

/// A side on which no shadow falls is found below a listed top, by its edges in the plate.
#[test]
fn a_side_that_the_plate_alone_shows_is_found() {
    let top =
        DMat4::from_rotation_translation(DQuat::from_rotation_y(-0.4), DVec3::new(0.13, HEIGHT_M, 0.03));
    let lit = side(top, DVec3::X);
    let (mut scene, shot) = session(&[(top, HALF_M), lit, side(top, DVec3::Z)]);
    scene.receivers.push(shot.scene.receivers[1].clone());
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    let known = observer.scene(&scene);
    let found = &known.receivers[2..];
    assert!(found.iter().any(|found| is_side(found, &lit)), "{found:?}");
}

/// Below a top that is listed already.
#[test]
fn a_side_of_a_listed_top_is_found() {
    let sides = sides();
    let all: Vec<_> = [(top(), HALF_M)].into_iter().chain(sides).collect();
    let (mut scene, shot) = session(&all);
    scene.receivers.push(shot.scene.receivers[1].clone());
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    let known = observer.scene(&scene);
    let lit = sides[0];
    assert!(
        known.receivers[2..].iter().any(|found| is_side(found, &lit)),
        "{:?}",
        known.receivers
    );
}
