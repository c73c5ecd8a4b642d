//! A plane above the table is found by the toy's shadow on it, and no plane is found if there is
//! none.

use app_core::alignment::Observer;
use app_core::scene::Scene;
use glam::{DMat4, DQuat, DVec2, DVec3};
use measure::photographer::world::toward;
use measure::photographer::{Ground, Lamp, Paint, Quality, Shot, World};

/// Tolerance of its height in metres: a shadow moves by a pixel for each millimetre.
const HEIGHT_M: f64 = 0.001;
const TILT_RAD: f64 = 0.03;

/// A plane that catches the shadow of the boxes, and is turned against them.
fn board(height_m: f64, tilt_rad: f64) -> DMat4 {
    let turn = DQuat::from_rotation_y(0.4) * DQuat::from_rotation_z(tilt_rad);
    DMat4::from_rotation_translation(turn, DVec3::new(-0.1, height_m, 0.0))
}

/// The boxes beside such a plane, which the scene does not contain.
fn session(world_from_board: Option<DMat4>) -> (Scene, Shot) {
    let mut world = World::boxes().resized([480, 270]);
    world = world.lit_by(vec![Lamp::bulb(toward(50.0, 90.0), 0.01, 0.75)]);
    world.bounces = false;
    world.quality = Quality {
        n_across: 2,
        n_light_rays: 24,
        n_sky_rays: 24,
    };
    world.grounds[0].paint = Paint::Waves {
        color: DVec3::new(0.45, 0.35, 0.25),
        amount: 0.2,
        wave_m: 0.03,
    };
    world
        .grounds
        .extend(world_from_board.map(|world_from_plane| Ground {
            world_from_plane,
            half_extent_m: DVec2::new(0.05, 0.06),
            paint: Paint::Even(DVec3::new(0.2, 0.35, 0.6)),
        }));
    let shot = Shot::of(&world).unwrap();
    let mut scene = shot.scene.clone();
    scene.receivers.truncate(1);
    (scene, shot)
}

/// Heights above the table in the middle of the board, and tilts: the estimated and the true ones.
fn found(height_m: f64, tilt_rad: f64) -> Option<([f64; 2], [f64; 2])> {
    let world_from_board = board(height_m, tilt_rad);
    let (scene, shot) = session(Some(world_from_board));
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    let told = observer.planes().first()?;
    let known = observer.scene(&scene);
    let plane_from_world = known.receivers[1].world_from_plane.inverse();
    let off = plane_from_world.transform_point3(world_from_board.w_axis.truncate());
    assert!(
        off.x.abs() <= known.receivers[1].half_extent_m.x,
        "the board's middle is not within what is found: {off}"
    );
    Some(([off.y, 0.0], [told.tilt_rad, tilt_rad]))
}

#[test]
fn a_level_plane_is_found() {
    let ([found_m, true_m], tilts) = found(0.018, 0.0).expect("a plane");
    assert!(
        (found_m - true_m).abs() < HEIGHT_M,
        "{:.2} mm off",
        1e3 * (found_m - true_m)
    );
    assert!(tilts[0] == 0.0, "{tilts:?}");
}

#[test]
fn a_tilted_plane_is_found() {
    let ([found_m, true_m], tilts) = found(0.022, -0.16).expect("a plane");
    assert!(
        (found_m - true_m).abs() < HEIGHT_M,
        "{:.2} mm off",
        1e3 * (found_m - true_m)
    );
    assert!((tilts[0] - tilts[1].abs()).abs() < TILT_RAD, "{tilts:?}");
}

#[test]
fn a_plane_that_is_listed_too_low_is_found_in_its_place() {
    let world_from_board = board(0.018, 0.0);
    let (mut scene, shot) = session(Some(world_from_board));
    let mut listed = shot.scene.receivers[1].clone();
    listed.world_from_plane.w_axis.y -= 0.006;
    scene.receivers.push(listed);
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    let known = observer.scene(&scene);
    assert_eq!(known.receivers.len(), 2);
    let off_m = known.receivers[1].world_from_plane.w_axis.y - world_from_board.w_axis.y;
    assert!(off_m.abs() < HEIGHT_M, "{:.2} mm off", 1e3 * off_m);
}

#[test]
fn no_plane_is_found_where_there_is_none() {
    let (scene, shot) = session(None);
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    assert!(observer.planes().is_empty());
    assert_eq!(observer.scene(&scene).receivers, scene.receivers);
}
