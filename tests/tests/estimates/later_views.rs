//! A first view that does not show the toy costs the views after it nothing, and one in which the toy is given
//! elsewhere mixes up no receivers.

use app_core::alignment::{Aligner, Observer};
use app_core::frame::FrameInput;
use app_core::scene::{Receiver, Scene, Surface};
use app_scene::geometry::nearest_receivers::nearest_to_toy;
use glam::{DMat4, DQuat, DVec2, DVec3};
use measure::photographer::Shot;

use super::planes::{HALF_M, HEIGHT_M, board, painted, session, waves};

/// A board of the table's material, which only a search for things in the table's colours finds; and the place before the
/// toy was put down.
fn hardly_visible() -> (Scene, Shot, FrameInput) {
    let (scene, shot) = painted(&[(board(0.025, -0.2), 1.4 * HALF_M)], &waves(0.88));
    let empty = shot.input.clone().with_image(scene.plates[0].image.clone());
    (scene, shot, empty)
}

#[test]
fn an_observer_searches_in_the_first_view_that_shows_the_toy() {
    let (scene, shot, empty) = hardly_visible();
    let mut observer = Observer::default();
    for input in [&empty, &shot.input] {
        observer.observed(&scene, input).unwrap();
    }
    assert!(!observer.planes().is_empty());
}

#[test]
fn an_aligner_searches_in_the_first_view_that_shows_the_toy() {
    let (scene, shot, empty) = hardly_visible();
    let mut aligner = Aligner::new(scene);
    let [_, found] = [&empty, &shot.input].map(|input| aligner.align(input).unwrap());
    assert!(!found.report.planes.is_empty(), "{:?}", found.report);
}

/// A patch of a wall is nearer to the toy where it is given than a top is, and farther away where it stands.
#[test]
fn a_corrected_top_replaces_no_other_receiver() {
    const OFF_M: f64 = 0.006;
    let world_from_board = board(0.018, 0.0);
    let (mut scene, shot) = session(&[(world_from_board, HALF_M)]);
    let mut listed = shot.scene.receivers[1].clone();
    listed.world_from_plane.w_axis.y -= 0.002;
    scene.receivers.push(listed);
    // Its back is turned to the camera. Its width is along the world's Z.
    let turn = DQuat::from_rotation_z(-std::f64::consts::FRAC_PI_2);
    let wall = |x_m: f64| Receiver {
        name: "wall".to_owned(),
        world_from_plane: DMat4::from_rotation_translation(turn, DVec3::new(x_m, 0.02, 0.0)),
        half_extent_m: DVec2::new(0.005, 0.1),
        surface: Surface::Textured,
    };
    let true_place = shot.input.world_from_object;
    let given_place = DMat4::from_translation(OFF_M * DVec3::X) * true_place;
    let with_wall = |x_m: f64| {
        let mut scene = scene.clone();
        scene.receivers.push(wall(x_m));
        let is_top_first = |place| nearest_to_toy(&scene, place)[1] == 1;
        let is_swapped = is_top_first(&true_place) && !is_top_first(&given_place);
        is_swapped.then_some(scene)
    };
    let places_m = (0..400).map(|step| 0.001 * f64::from(step));
    let scene = places_m
        .filter_map(with_wall)
        .next()
        .expect("a place for the wall");
    let wall = scene.receivers[2].clone();
    let mut aligner = Aligner::new(scene);
    let input = shot.input.clone().with_world_from_object(given_place);
    let found = aligner.align(&input).unwrap();
    assert!(found.report.pose.unwrap().is_applied, "{:?}", found.report);
    let receivers = &aligner.scene().receivers;
    assert_eq!(receivers[2], wall);
    let off_m = receivers[1].world_from_plane.w_axis.y - world_from_board.w_axis.y;
    assert!(off_m.abs() < HEIGHT_M, "{:.2} mm off", 1e3 * off_m);
}
