//! The points of a thing that stands up, found by the toy's shadow on it.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::scene::{Image, Scene};
use app_core::things::{HEIGHT_STEP_M, Things};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};
use glam::{DVec2, DVec3, UVec2, Vec3Swizzles};

use super::bundled::SESSION;

/// An upright board in the shadow of the bundled picture: its first pixel, and the one after its
/// last.
const BOARD: [UVec2; 2] = [UVec2::new(365, 220), UVec2::new(415, 262)];
const TEAL: [f32; 3] = [0.02, 0.2, 0.23];

/// The point of the board that a pixel shows, which stands on the table along the board's lowest
/// row.
fn point_at(input: &FrameInput, pixel: UVec2) -> DVec3 {
    let camera = &input.camera;
    let eye = camera.world_from_camera.w_axis.truncate();
    let ray = camera.intrinsics.ray(pixel.as_dvec2() + 0.5);
    let ray = camera.world_from_camera.transform_vector3(ray);
    let along = ray.xz().normalize();
    let foot = |far_m: f64| eye.xz() + far_m * along;
    let row = |at: DVec2| {
        camera
            .pixel_of(DVec3::new(at.x, 0.0, at.y))
            .map_or(1e9, |px| px.y)
    };
    let [mut near_m, mut far_m] = [0.05, 2.0];
    for _ in 0..40 {
        let middle_m = 0.5 * (near_m + far_m);
        if row(foot(middle_m)) > f64::from(BOARD[1].y) {
            near_m = middle_m;
        } else {
            far_m = middle_m;
        }
    }
    let at = foot(near_m);
    DVec3::new(at.x, eye.y + near_m / ray.xz().length() * ray.y, at.y)
}

/// The lights' share of the board's light that the toy leaves at a point: that of the table where
/// its shadow falls in the picture.
fn left_at((scene, input): (&Scene, &FrameInput), point: DVec3) -> f32 {
    let to_light = scene.lights[0].vector_from(point);
    let below = point - point.y / to_light.y * to_light;
    let at = input.camera.pixel_of(below).unwrap().as_uvec2();
    let sum = |image: &Image| {
        let index = 4 * (at.y * image.width_px + at.x) as usize;
        let codes = image.rgba8[index..index + 3].iter();
        codes
            .map(|code| linear_from_srgb(f32::from(*code) / 255.0))
            .sum::<f32>()
    };
    (sum(input.image.rgba()) / sum(&scene.plates[0].image)).min(1.0)
}

/// Points of the things in the session with the board in frame and plate, below the toy's shadow or
/// as bright as in the plate.
fn found(has_shadow: bool) -> Option<Things> {
    let (scene, input) = &*SESSION;
    let (mut frame, mut plate) = (
        Image::clone(input.image.rgba()),
        Image::clone(&scene.plates[0].image),
    );
    let [first, end] = BOARD;
    for at in (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| UVec2::new(x, y))) {
        let left = if has_shadow {
            left_at((scene, input), point_at(input, at))
        } else {
            1.0
        };
        let index = 4 * (at.y * frame.width_px + at.x) as usize;
        // Not of one code, as no object is.
        let grain = ((7 * at.x + 13 * at.y) % 5) as u8;
        #[allow(clippy::cast_possible_truncation, reason = "a code")]
        let code = |light: f32| (255.0 * srgb_from_linear(light)).round() as u8 + grain;
        for (channel, teal) in TEAL.into_iter().enumerate() {
            frame.rgba8[index + channel] = code(left * teal);
            plate.rgba8[index + channel] = code(teal);
        }
    }
    let mut scene = Scene::clone(scene);
    scene.plates[0].image = Arc::new(plate);
    let input = input.clone().with_image(Arc::new(frame));
    Observer::default().observed(&scene, &input).unwrap().things
}

#[test]
fn a_thing_in_the_toys_shadow_stands_up() {
    let things = found(true).unwrap();
    let (mut n_raised, mut off_m, mut shares) = (0, 0.0, Vec::new());
    let [first, end] = BOARD;
    for at in (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| UVec2::new(x, y))) {
        let point = things.raised((at.y * things.size_px().x + at.x) as usize);
        if point.height() > 0 {
            n_raised += 1;
            let height_m = f64::from(point.height()) * f64::from(HEIGHT_STEP_M);
            off_m += (height_m - point_at(&SESSION.1, at).y).abs();
            shares.push(point.of_lights());
        }
    }
    let part = f64::from(n_raised) / f64::from((end - first).element_product());
    let off_mm = 1e3 * off_m / f64::from(n_raised);
    shares.sort_unstable();
    let share = f64::from(shares[shares.len() / 2]) / 255.0;
    // Measured: .98, .28 and .58.
    assert!(
        part > 0.9 && off_mm < 0.6 && (share - 0.58).abs() < 0.05,
        "{part:.2} of it, {off_mm:.2} mm off, {share:.2} of the lights"
    );
}

#[test]
fn a_thing_without_the_toys_shadow_has_no_points() {
    let things = found(false).unwrap();
    assert!(!things.has_raised());
}
