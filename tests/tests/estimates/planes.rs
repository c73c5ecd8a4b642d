//! A plane above the table is found by the toy's shadow on it, without sides if it is a board, and no
//! plane is found if there is none. Depths or a mesh of the place help where little of the shadow
//! falls.

use app_core::alignment::{Aligner, Observer};
use app_core::scene::{Receiver, Scene};
use app_core::things::Mark;
use app_scene::depth::Depth;
use app_scene::place_mesh::PlaceMesh;
use glam::{DMat4, DQuat, DVec2, DVec3, UVec2};
use measure::photographer::world::toward;
use measure::photographer::{Ground, Lamp, Paint, Quality, Shot, World};
use measure::random::Random;

/// Tolerance of its height in metres: a shadow moves by a pixel for each millimetre.
pub(super) const HEIGHT_M: f64 = 0.001;
const TILT_RAD: f64 = 0.03;
/// Tolerance of a light's direction, in radians.
const LIGHT_RAD: f64 = 0.005;
/// The same by an exact mesh.
const EXACT_M: f64 = 0.0003;
/// Tolerance of its middle and half sides in metres: one pixel and a half.
const EXTENT_M: f64 = 0.0025;
/// Half the sides of the board.
pub(super) const HALF_M: DVec2 = DVec2::new(0.05, 0.06);
/// Noise of a depth sensor, in millimetres, and the size of its picture.
const NOISE_MM: f64 = 5.0;
const DEPTH_PX: UVec2 = UVec2::new(256, 144);

/// The table's paint, times a brightness.
pub(super) fn waves(brightness: f64) -> Paint {
    Paint::Waves {
        color: brightness * DVec3::new(0.45, 0.35, 0.25),
        amount: 0.2,
        wave_m: 0.03,
    }
}

/// A plane that catches the shadow of the boxes, and is turned against them.
pub(super) fn board(height_m: f64, tilt_rad: f64) -> DMat4 {
    board_at(-0.1, height_m, tilt_rad)
}

fn board_at(x_m: f64, height_m: f64, tilt_rad: f64) -> DMat4 {
    let turn = DQuat::from_rotation_y(0.4) * DQuat::from_rotation_z(tilt_rad);
    DMat4::from_rotation_translation(turn, DVec3::new(x_m, height_m, 0.0))
}

/// The boxes beside such planes, which the scene does not contain.
pub(super) fn session(planes: &[(DMat4, DVec2)]) -> (Scene, Shot) {
    painted(planes, &Paint::Even(DVec3::new(0.2, 0.35, 0.6)))
}

/// The boxes beside planes of a paint.
fn boxes(planes: &[(DMat4, DVec2)], paint: &Paint) -> World {
    let mut world = World::boxes().resized([480, 270]);
    world = world.lit_by(vec![Lamp::bulb(toward(50.0, 90.0), 0.01, 0.75)]);
    world.bounces = false;
    world.quality = Quality {
        n_across: 2,
        n_light_rays: 24,
        n_sky_rays: 24,
    };
    world.grounds[0].paint = waves(1.0);
    world
        .grounds
        .extend(planes.iter().map(|(world_from_plane, half_extent_m)| Ground {
            world_from_plane: *world_from_plane,
            half_extent_m: *half_extent_m,
            paint: *paint,
        }));
    world
}

/// The same with planes of a paint.
pub(super) fn painted(planes: &[(DMat4, DVec2)], paint: &Paint) -> (Scene, Shot) {
    let world = boxes(planes, paint);
    let shot = Shot::of(&world).unwrap();
    let mut scene = shot.scene.clone();
    scene.receivers.truncate(1);
    (scene, shot)
}

/// Depth at a place of the camera's picture: that of the nearest receiver.
fn depth_mm(receivers: &[Receiver], shot: &Shot, at_px: DVec2) -> f64 {
    let camera = &shot.input.camera;
    let ray = camera.intrinsics.ray(at_px);
    let depth_m = |receiver: &Receiver| {
        let plane_from_camera = receiver.world_from_plane.inverse() * camera.world_from_camera;
        let eye = plane_from_camera.w_axis.truncate();
        let along = plane_from_camera.transform_vector3(ray);
        let depth_m = -eye.y / along.y;
        let at = eye + depth_m * along;
        let is_on = at.x.abs() <= receiver.half_extent_m.x && at.z.abs() <= receiver.half_extent_m.y;
        (is_on && depth_m > 0.0).then_some(depth_m)
    };
    1e3 * receivers.iter().filter_map(depth_m).fold(f64::INFINITY, f64::min)
}

/// Depths of the receivers with noise; the toy, which hides some of them, is left out.
fn depths(shot: &Shot, offset_mm: f64) -> Depth {
    let mut random = Random::new(11);
    let size_px = UVec2::new(shot.scene.width_px, shot.scene.height_px).as_dvec2();
    let pixels = (0..DEPTH_PX.y).flat_map(|y| (0..DEPTH_PX.x).map(move |x| UVec2::new(x, y)));
    let depths = pixels.map(|at| {
        let at_px = (at.as_dvec2() + 0.5) * size_px / DEPTH_PX.as_dvec2();
        let seen_mm = depth_mm(&shot.scene.receivers, shot, at_px);
        let noise = (0..12).map(|_| random.uniform() - 0.5).sum::<f64>();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast saturates"
        )]
        let seen_mm = if seen_mm.is_finite() {
            (seen_mm + offset_mm + NOISE_MM * noise).round() as u16
        } else {
            0
        };
        seen_mm
    });
    Depth::new(DEPTH_PX, depths.collect::<Vec<_>>()).unwrap()
}

/// Heights above the table in the middle of the board, and tilts: the estimated and the true ones.
fn found_in(
    (scene, shot): &(Scene, Shot),
    depth: Option<Depth>,
    (world_from_board, tilt_rad): (DMat4, f64),
) -> Option<([f64; 2], [f64; 2])> {
    let mut observer = Observer::default();
    observer
        .observed(scene, &shot.input.clone().with_depth(depth))
        .unwrap();
    let reported = observer.planes().first()?;
    assert_eq!(observer.planes().len(), 1, "a board has no upright sides");
    let known = observer.scene(scene);
    let found = &known.receivers[1];
    let off = found
        .world_from_plane
        .inverse()
        .transform_point3(world_from_board.w_axis.truncate());
    let [half_m, true_half_m] =
        [found.half_extent_m, HALF_M].map(|half| [half.min_element(), half.max_element()]);
    // A tilted one is continued down to the table.
    let most_m = if tilt_rad == 0.0 { EXTENT_M } else { 0.4 * HALF_M.y };
    assert!(
        (0..2).all(|side| (half_m[side] - true_half_m[side]).abs() < most_m)
            && off.x.abs() < most_m
            && off.z.abs() < most_m,
        "half sides of {half_m:?} m, the middle {off} m off"
    );
    Some(([off.y, 0.0], [reported.tilt_rad, tilt_rad]))
}

fn found(height_m: f64, tilt_rad: f64) -> Option<([f64; 2], [f64; 2])> {
    let world_from_board = board(height_m, tilt_rad);
    let session = session(&[(world_from_board, HALF_M)]);
    found_in(&session, None, (world_from_board, tilt_rad))
}

fn assert_height([found_m, true_m]: [f64; 2]) {
    assert!(
        (found_m - true_m).abs() < HEIGHT_M,
        "{:.2} mm off",
        1e3 * (found_m - true_m)
    );
}

#[test]
fn a_level_plane_is_found() {
    let (heights_m, tilts) = found(0.018, 0.0).expect("a plane");
    assert_height(heights_m);
    assert!(tilts[0] == 0.0, "{tilts:?}");
}

#[test]
fn a_tilted_plane_is_found() {
    let (heights_m, tilts) = found(0.022, -0.16).expect("a plane");
    assert_height(heights_m);
    assert!((tilts[0] - tilts[1].abs()).abs() < TILT_RAD, "{tilts:?}");
}

/// Every second square has the table's colour, so that the board does not grow to its edges.
#[test]
fn a_level_plane_of_checks_is_found() {
    let world_from_board = board(0.018, 0.0);
    let colors = [DVec3::new(0.45, 0.35, 0.25), DVec3::new(0.25, 0.3, 0.45)];
    let checks = Paint::Tiles {
        colors,
        side_m: 0.006,
    };
    let session = painted(&[(world_from_board, HALF_M)], &checks);
    let (heights_m, tilts) = found_in(&session, None, (world_from_board, 0.0)).expect("a plane");
    assert_height(heights_m);
    assert!(tilts[0] == 0.0, "{tilts:?}");
}

/// A board of the table's material that is a little darker: its colours alone show neither that it
/// is there nor how far it reaches, so its extent is not tested.
#[test]
fn a_tilted_plane_that_looks_like_the_table_is_found() {
    let tilt_rad = -0.2;
    let world_from_board = board(0.025, tilt_rad);
    let (scene, shot) = painted(&[(world_from_board, 1.4 * HALF_M)], &waves(0.88));
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    let told = observer.planes().first().expect("a plane");
    let found = &observer.scene(&scene).receivers[1];
    let middle = world_from_board.w_axis.truncate();
    let off_m = found.world_from_plane.inverse().transform_point3(middle).y;
    assert_height([off_m, 0.0]);
    assert!((told.tilt_rad + tilt_rad).abs() < TILT_RAD, "{}", told.tilt_rad);
}

#[test]
fn noisy_depths_do_no_harm() {
    let world_from_board = board(0.022, -0.16);
    let session = session(&[(world_from_board, HALF_M)]);
    let depth = depths(&session.1, 20.0);
    let (heights_m, tilts) = found_in(&session, Some(depth), (world_from_board, -0.16)).expect("a plane");
    assert_height(heights_m);
    assert!((tilts[0] - tilts[1].abs()).abs() < TILT_RAD, "{tilts:?}");
}

/// A mesh of the receivers, in a world that is moved and turned against theirs.
fn mesh(receivers: &[Receiver], there_from_world: DMat4, deviation_m: Option<f64>) -> PlaceMesh {
    let corners = receivers.iter().flat_map(|receiver| {
        let half_m = receiver.half_extent_m.min(DVec2::splat(0.6));
        let there_from_plane = there_from_world * receiver.world_from_plane;
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, z)| {
            let at = DVec3::new(x * half_m.x, 0.0, z * half_m.y);
            there_from_plane.transform_point3(at).as_vec3()
        })
    });
    let corners: Vec<_> = corners.collect();
    let quads = (0..).step_by(4).take(receivers.len());
    // One of the triangles is seen from its back.
    let triangles: Vec<[u32; 3]> = quads
        .flat_map(|first| [[first, first + 1, first + 2], [first, first + 3, first + 2]])
        .collect();
    PlaceMesh::new(corners, triangles, deviation_m).unwrap()
}

/// A mesh that is a centimetre off along each axis, and turned and tilted by degrees.
fn misplaced() -> DMat4 {
    DMat4::from_rotation_translation(
        DQuat::from_rotation_y(0.05) * DQuat::from_rotation_x(0.035),
        DVec3::splat(0.01),
    )
}

/// The found plane of a board with little of the toy's shadow, by a mesh of the place.
fn found_by_mesh(there_from_world: DMat4, deviation_m: Option<f64>) -> Option<[f64; 2]> {
    let world_from_board = board_at(-0.17, 0.018, 0.0);
    let (scene, shot) = session(&[(world_from_board, HALF_M)]);
    let mesh = mesh(&shot.scene.receivers, there_from_world, deviation_m);
    let scene = scene.with_place_mesh(Some(mesh));
    let (heights_m, _) = found_in(&(scene, shot), None, (world_from_board, 0.0))?;
    Some(heights_m)
}

#[test]
fn a_mesh_finds_a_plane_with_little_shadow() {
    assert_height(found_by_mesh(DMat4::IDENTITY, None).expect("a plane"));
    let [found_m, true_m] = found_by_mesh(DMat4::IDENTITY, Some(1e-4)).expect("a plane");
    assert!((found_m - true_m).abs() < EXACT_M, "{found_m} m");
    // The table around it shows how far the mesh is off.
    assert_height(found_by_mesh(misplaced(), Some(1e-4)).expect("a plane"));
}

#[test]
fn a_mesh_of_another_place_does_no_harm() {
    let world_from_board = board(0.022, -0.16);
    let (scene, shot) = session(&[(world_from_board, HALF_M)]);
    // In it, the board is level and 10 mm lower.
    let mut other = shot.scene.receivers.clone();
    other[1].world_from_plane = board(0.012, 0.0);
    let scene = scene.with_place_mesh(Some(mesh(&other, DMat4::IDENTITY, Some(1e-4))));
    let (heights_m, tilts) = found_in(&(scene, shot), None, (world_from_board, -0.16)).expect("a plane");
    assert_height(heights_m);
    assert!((tilts[0] - tilts[1].abs()).abs() < TILT_RAD, "{tilts:?}");
}

/// Points with noise are one of two starts of a search.
#[test]
fn a_noisy_mesh_of_another_tilt_does_no_harm() {
    let world_from_board = board(0.022, -0.16);
    let (scene, shot) = session(&[(world_from_board, HALF_M)]);
    let mut other = shot.scene.receivers.clone();
    other[1].world_from_plane = board(0.022, -0.06);
    let scene = scene.with_place_mesh(Some(mesh(&other, DMat4::IDENTITY, Some(5e-3))));
    let (heights_m, tilts) = found_in(&(scene, shot), None, (world_from_board, -0.16)).expect("a plane");
    assert_height(heights_m);
    assert!((tilts[0] - tilts[1].abs()).abs() < TILT_RAD, "{tilts:?}");
}

/// The shadow alone does not determine it; a sensor that is 20 mm off does.
#[test]
fn depths_find_a_plane_with_little_shadow() {
    let world_from_board = board_at(-0.17, 0.018, 0.0);
    let session = session(&[(world_from_board, HALF_M)]);
    let place = (world_from_board, 0.0);
    assert!(found_in(&session, None, place).is_none());
    let depth = depths(&session.1, 20.0);
    let (heights_m, _) = found_in(&session, Some(depth), place).expect("a plane");
    assert_height(heights_m);
}

#[test]
fn a_plane_that_is_listed_too_low_is_found_in_its_place() {
    let world_from_board = board(0.018, 0.0);
    let (mut scene, shot) = session(&[(world_from_board, HALF_M)]);
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

/// As trackers list planes, 2 mm off; an exact one stays.
#[test]
fn a_plane_that_is_listed_a_little_off_is_corrected() {
    let world_from_board = board(0.018, 0.0);
    let (scene, shot) = session(&[(world_from_board, HALF_M)]);
    let exact = shot.scene.receivers[1].clone();
    let corrected = |listed: Receiver| {
        let mut scene = scene.clone();
        scene.receivers.push(listed);
        let mut observer = Observer::default();
        observer.observed(&scene, &shot.input).unwrap();
        let known = observer.scene(&scene);
        assert_eq!(known.receivers.len(), 2);
        known.receivers[1].clone()
    };
    assert_eq!(corrected(exact.clone()), exact);
    let mut listed = exact.clone();
    listed.world_from_plane.w_axis.y += 0.002;
    let found = corrected(listed);
    let off_m = found.world_from_plane.w_axis.y - exact.world_from_plane.w_axis.y;
    assert!(off_m.abs() < HEIGHT_M, "{:.2} mm off", 1e3 * off_m);
}

/// A line of the table's squares is clearer than a side of the board, but the toy's shadow on the table between
/// them shows that the board does not reach there.
#[test]
fn a_listed_plane_does_not_grow_to_a_line_of_the_table() {
    let world_from_board = board(0.018, 0.0);
    let color = DVec3::new(0.45, 0.35, 0.25);
    let mut world = boxes(&[(world_from_board, HALF_M)], &Paint::Even(0.9 * color));
    let line_m = world_from_board.transform_point3(DVec3::new(HALF_M.x + 0.012, 0.0, 0.1));
    let table = &mut world.grounds[0];
    table.paint = Paint::Tiles {
        colors: [color, 0.4 * color],
        side_m: 0.2,
    };
    table.world_from_plane = DMat4::from_rotation_translation(
        DQuat::from_mat4(&world_from_board),
        DVec3::new(line_m.x, 0.0, line_m.z),
    );
    let shot = Shot::of(&world).unwrap();
    let mut observer = Observer::default();
    observer.observed(&shot.scene, &shot.input).unwrap();
    let known = observer.scene(&shot.scene);
    assert_eq!(known.receivers, shot.scene.receivers);
}

/// Lights that are fitted to a board that is listed too low agree with it, so it is corrected in those
/// that its surroundings show.
#[test]
fn a_listed_plane_is_corrected_in_the_lights_of_the_ground() {
    let mut world_from_board = board_at(-0.12, 0.018, 0.0);
    world_from_board.w_axis.z = 0.06;
    let (mut scene, shot) = session(&[(world_from_board, 1.2 * HALF_M)]);
    let mut listed = shot.scene.receivers[1].clone();
    listed.world_from_plane.w_axis.y -= 0.002;
    scene.receivers.push(listed);
    let lamp = scene.lights[0];
    let mut aligner = Aligner::new(scene);
    let lights = aligner.align(&shot.input).unwrap().lights;
    let planes = &aligner.scene().receivers[1..];
    assert_eq!(planes.len(), 1, "a board has no upright sides");
    let off_m = planes[0].world_from_plane.w_axis.y - world_from_board.w_axis.y;
    assert!(off_m.abs() < HEIGHT_M, "{:.2} mm off", 1e3 * off_m);
    let vectors = [lights.map_or(lamp, |lights| lights[0]), lamp];
    let [found, listed] = vectors.map(|light| light.vector_from(DVec3::ZERO));
    let off_rad = found.angle_between(listed);
    assert!(off_rad < LIGHT_RAD, "{:.2} degrees off", off_rad.to_degrees());
}

/// Lights that nobody lists are a compromise at first: they follow the shadow on the board, too.
#[test]
fn a_plane_is_found_in_unknown_lights() {
    let world_from_board = board_at(-0.13, 0.018, 0.0);
    let (mut scene, shot) = session(&[(world_from_board, HALF_M)]);
    let lamp = std::mem::take(&mut scene.lights)[0];
    let mut aligner = Aligner::new(scene);
    let found = aligner.align(&shot.input).unwrap();
    let planes = &aligner.scene().receivers[1..];
    assert_eq!(planes.len(), 1, "{:?}", found.report);
    let off_m = planes[0].world_from_plane.w_axis.y - world_from_board.w_axis.y;
    assert!(off_m.abs() < HEIGHT_M, "{:.2} mm off", 1e3 * off_m);
    let directions = [&found.lights.unwrap()[0], &lamp].map(|light| light.vector_from(DVec3::ZERO));
    let off_rad = directions[0].angle_between(directions[1]);
    assert!(off_rad < LIGHT_RAD, "{:.2} degrees off", off_rad.to_degrees());
}

#[test]
fn no_plane_is_found_where_there_is_none() {
    let (scene, shot) = session(&[]);
    let mut observer = Observer::default();
    observer.observed(&scene, &shot.input).unwrap();
    assert!(observer.planes().is_empty());
    assert_eq!(observer.scene(&scene).receivers, scene.receivers);
}

/// The toy's shadow crosses the board's own shadow on the table, and changes nothing there.
#[test]
fn no_thing_is_found_in_the_shadow_of_a_listed_plane() {
    let (mut scene, shot) = session(&[(board_at(-0.06, 0.035, 0.0), HALF_M)]);
    scene.receivers.push(shot.scene.receivers[1].clone());
    let mut observer = Observer::default();
    let things = observer.observed(&scene, &shot.input).unwrap().things;
    assert!(
        things.is_none(),
        "{:?}",
        things.map(|things| things.count(Mark::Thing))
    );
}
