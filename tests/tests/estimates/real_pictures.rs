//! A toy is found in pictures as cameras make them, on its table, in its size, and with the
//! reported accuracy.

use std::sync::Arc;

use app_core::alignment::{Aligner, Alignment, AlignmentWarning};
use app_core::frame::FrameInput;
use app_core::scene::{Image, Light, Scene};
use app_scene::geometry::color::{linear_of_codes, srgb_from_linear};
use glam::{DMat4, DQuat, DVec3};

use super::bundled::{SESSION, middle};

/// Effect of a camera on a picture.
#[derive(Clone, Copy, Debug)]
enum Camera {
    Ideal,
    /// Out of focus, by a standard deviation in pixels.
    Soft(f32),
    /// Sharpened, by this share of the difference between the codes and their blur of 1.2 px.
    Sharpened(f32),
}

impl Camera {
    fn develop(self, image: &Image) -> Image {
        let table = linear_of_codes();
        let planes = |of: &dyn Fn(u8) -> f32| {
            [0, 1, 2].map(|channel| {
                let texels = image.rgba8.chunks_exact(4);
                texels.map(|texel| of(texel[channel])).collect::<Vec<f32>>()
            })
        };
        let planes: [Vec<f32>; 3] = match self {
            Self::Ideal => return image.clone(),
            Self::Soft(deviation_px) => planes(&|code| table[usize::from(code)]).map(|plane| {
                let soft = spread(image, &plane, deviation_px);
                soft.into_iter()
                    .map(|linear| 255.0 * srgb_from_linear(linear))
                    .collect()
            }),
            Self::Sharpened(part) => planes(&f32::from).map(|plane| {
                let soft = spread(image, &plane, 1.2);
                plane
                    .iter()
                    .zip(soft)
                    .map(|(code, soft)| code + part * (code - soft))
                    .collect()
            }),
        };
        let mut developed = image.clone();
        for (index, texel) in developed.rgba8.chunks_exact_mut(4).enumerate() {
            for (code, plane) in texel.iter_mut().zip(&planes) {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
                let rounded = plane[index].round().clamp(0.0, 255.0) as u8;
                *code = rounded;
            }
        }
        developed
    }
}

/// Gaussian blur; the border is extended.
fn spread(image: &Image, plane: &[f32], deviation_px: f32) -> Vec<f32> {
    let [width, height] = [image.width_px, image.height_px]
        .map(i32::try_from)
        .map(Result::unwrap);
    #[expect(clippy::cast_possible_truncation, reason = "some pixels")]
    let reach = (3.0 * deviation_px).ceil() as i32;
    let weights: Vec<f32> = (-reach..=reach)
        .map(|step| (-0.5 * (step as f32 / deviation_px).powi(2)).exp())
        .collect();
    let total: f32 = weights.iter().sum();
    let mut plane = plane.to_vec();
    for (dx, dy) in [(1, 0), (0, 1)] {
        let at = |x: i32, y: i32| plane[(y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize];
        let taps = |x: i32, y: i32| {
            (-reach..=reach)
                .zip(&weights)
                .map(move |(step, weight)| (x + step * dx, y + step * dy, weight))
        };
        let of_pixel =
            |x: i32, y: i32| taps(x, y).map(|(x, y, weight)| weight * at(x, y)).sum::<f32>() / total;
        plane = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| of_pixel(x, y))
            .collect();
    }
    plane
}

/// The first frame, with the toy moved about its centre by millimetres and degrees, in a picture as
/// a camera makes it.
fn disturbed(camera: Camera, mm: DVec3, (axis, deg): (DVec3, f64)) -> FrameInput {
    let recorded = &SESSION.1;
    let place = middle(&recorded.world_from_object);
    let moved = DMat4::from_translation(place + 1e-3 * mm)
        * DMat4::from_axis_angle(axis.normalize(), deg.to_radians())
        * DMat4::from_translation(-place);
    let mut input = recorded
        .clone()
        .with_world_from_object(moved * recorded.world_from_object);
    input.image = Arc::new(camera.develop(recorded.image.rgba())).into();
    input
}

/// Lights whose uncertainty is stated do not correct the pose, which is then the outline's alone.
fn align(mut scene: Scene, input: &FrameInput) -> Alignment {
    scene.uncertainty.lights.direction_rad = Some(0.0);
    Aligner::new(scene).align(input).unwrap()
}

/// Error of the toy's centre: along the view, and beside it, in millimetres.
fn off_mm(found: &Alignment) -> [f64; 2] {
    let camera_from_world = SESSION.1.camera.world_from_camera.inverse();
    let place = |pose: &DMat4| camera_from_world.transform_point3(middle(pose));
    let off = place(&found.world_from_object) - place(&SESSION.1.world_from_object);
    [1e3 * off.z.abs(), 1e3 * off.truncate().length()]
}

#[test]
fn a_toy_is_found_in_soft_and_sharpened_pictures_and_as_well_as_is_claimed() {
    for (camera, [most_along_mm, most_beside_mm]) in [
        (Camera::Ideal, [0.3, 0.1]),
        (Camera::Sharpened(0.7), [0.3, 0.1]),
        (Camera::Soft(1.0), [0.4, 0.15]),
        (Camera::Soft(2.0), [0.6, 0.45]),
    ] {
        for (mm, turn) in [
            (DVec3::new(2.0, 1.0, -2.0), (DVec3::new(1.0, 2.0, 0.5), 1.5)),
            (DVec3::new(-0.4, 0.0, 0.3), (DVec3::Y, 0.5)),
        ] {
            let found = align(SESSION.0.clone(), &disturbed(camera, mm, turn));
            let pose = found.report.pose.unwrap();
            assert!(pose.is_applied, "{camera:?}: {pose:?}");
            let [along_mm, beside_mm] = off_mm(&found);
            assert!(
                along_mm < most_along_mm && beside_mm < most_beside_mm,
                "{camera:?}: {along_mm} mm along, {beside_mm} mm beside"
            );
            let claimed_mm = [pose.deviation.depth_m, pose.deviation.lateral_m].map(|m| 1e3 * m);
            assert!(
                along_mm < 3.0 * claimed_mm[0] && beside_mm < 3.0 * claimed_mm[1],
                "{camera:?}: {along_mm} and {beside_mm} mm, claimed {claimed_mm:?}"
            );
            assert!(
                claimed_mm[0] < 1.0 && claimed_mm[1] < 0.3,
                "{camera:?}: claimed {claimed_mm:?}"
            );
            assert!(found.warnings.is_empty(), "{camera:?}: {:?}", found.warnings);
        }
    }
}

#[test]
fn the_spread_of_a_soft_picture_is_found() {
    let of = |camera: Camera| {
        let found = align(
            SESSION.0.clone(),
            &disturbed(camera, DVec3::ZERO, (DVec3::Y, 0.0)),
        );
        found.report.pose.unwrap().spread_px
    };
    assert!(of(Camera::Ideal) < 0.4, "{}", of(Camera::Ideal));
    let soft_px = of(Camera::Soft(2.0));
    assert!((1.7..2.3).contains(&soft_px), "{soft_px}");
}

#[test]
fn a_toy_stands_on_its_receiver_however_it_was_given() {
    let tilted = disturbed(
        Camera::Ideal,
        DVec3::new(0.5, 1.5, 0.5),
        (DVec3::new(1.0, 0.3, -1.0), 1.2),
    );
    for resting in [None, Some(true)] {
        let found = align(SESSION.0.clone().with_resting(resting), &tilted);
        let stand = found.report.pose.unwrap().stand.unwrap();
        assert!(
            stand.height_m.abs() < 3e-4 && stand.lean_rad < 0.006,
            "{resting:?}: {stand:?}"
        );
    }
    let floating = align(SESSION.0.clone().with_resting(Some(false)), &tilted);
    assert_eq!(floating.report.pose.unwrap().stand, None);
    assert!(off_mm(&floating)[0] < 0.4, "{:?}", off_mm(&floating));
}

#[test]
fn a_receiver_that_is_listed_too_low_is_told_by_the_toy_above_it() {
    let mut scene = SESSION.0.clone();
    scene.receivers[0].world_from_plane *= DMat4::from_translation(-0.003 * DVec3::Y);
    let found = align(
        scene.clone(),
        &disturbed(Camera::Ideal, DVec3::ZERO, (DVec3::Y, 0.0)),
    );
    let told = found.warnings.iter().find_map(|warning| match warning {
        AlignmentWarning::OffReceiver { height_m, .. } => Some(*height_m),
        _ => None,
    });
    let height_m = told.unwrap_or_else(|| panic!("{:?}", found.report.pose));
    assert!((height_m - 0.003).abs() < 5e-4, "{height_m}");
    // The toy stays in its place in the picture.
    assert!(off_mm(&found)[0] < 0.3, "{:?}", off_mm(&found));
}

#[test]
fn a_toy_that_is_larger_than_its_model_is_found_larger_where_it_stands() {
    let smaller = DMat4::from_scale(DVec3::splat(1.0 / 1.01));
    let input = disturbed(Camera::Ideal, DVec3::ZERO, (DVec3::Y, 0.0));
    let world_from_object = input.world_from_object * smaller;
    let found = align(
        SESSION.0.clone(),
        &input.with_world_from_object(world_from_object),
    );
    let pose = found.report.pose.unwrap();
    assert!(
        pose.is_applied && (pose.size_ratio - 1.01).abs() < 2e-3,
        "{pose:?}"
    );
    assert!(off_mm(&found)[0] < 0.3, "{:?}", off_mm(&found));
}

/// The table is inclined about one foot, so that the others are given in the air or below it. A smaller toy on its plane
/// looks like a higher one.
#[test]
fn a_toy_that_is_given_on_one_foot_keeps_its_size_and_height() {
    for deg in [2.0_f64, 3.5] {
        let foot = DMat4::from_translation(DVec3::new(0.0192, 0.0, 0.0));
        let inclined = foot * DMat4::from_axis_angle(DVec3::NEG_Z, deg.to_radians()) * foot.inverse();
        let mut scene = SESSION.0.clone();
        scene.receivers[0].world_from_plane = inclined * scene.receivers[0].world_from_plane;
        let start = disturbed(Camera::Ideal, DVec3::new(0.0, 0.0, -2.6), (DVec3::Y, 1.0));
        let found = align(scene, &start);
        let pose = found.report.pose.unwrap();
        assert!(
            pose.is_applied && (pose.size_ratio - 1.0).abs() < 1e-6,
            "{pose:?}"
        );
        assert!(off_mm(&found)[0] < 0.3, "{:?}", off_mm(&found));
    }
}

/// A start in a soft picture, with a listed light five degrees off.
fn soft_start() -> FrameInput {
    let start = disturbed(Camera::Soft(2.0), DVec3::new(2.0, 0.0, -2.0), (DVec3::Y, 1.5));
    let Light::Sphere {
        position_in_world,
        radius_m,
    } = SESSION.0.lights[0]
    else {
        unreachable!("the bundled session has a bulb")
    };
    let turned = Light::Sphere {
        position_in_world: DQuat::from_rotation_y(5_f64.to_radians()) * position_in_world,
        radius_m,
    };
    start.with_lights(Some(vec![turned].into()))
}

/// A soft outline says little about the distance.
#[test]
fn the_shadow_says_how_far_away_a_toy_that_is_out_of_focus_is() {
    let start = soft_start();
    let by_outline = align(SESSION.0.clone(), &start);
    let with_shadow = Aligner::new(SESSION.0.clone()).align(&start).unwrap();
    assert!(with_shadow.lights.is_some());
    let [by_outline_mm, with_shadow_mm] = [by_outline, with_shadow].map(|found| off_mm(&found)[0]);
    assert!(
        with_shadow_mm < 0.6 * by_outline_mm,
        "{with_shadow_mm} mm, {by_outline_mm} mm by the outline alone"
    );
}

/// The pose is kept that outline and shadow found together, and so are the lights.
#[test]
fn another_picture_does_not_undo_what_the_shadow_says() {
    let start = soft_start();
    let mut aligner = Aligner::new(SESSION.0.clone());
    let first = aligner.align(&start).unwrap();
    let mut image = Image::clone(start.image.rgba());
    for code in image.rgba8.iter_mut().step_by(7) {
        *code ^= 1;
    }
    let mut next = start.clone();
    next.image = Arc::new(image).into();
    let second = aligner.align(&next).unwrap();
    assert_eq!(second.world_from_object, first.world_from_object);
    assert_eq!(second.lights, first.lights);
}

/// Its feet are not those that it would have as inclined as it is given.
#[test]
fn a_toy_that_certainly_stands_is_put_upright() {
    let start = disturbed(Camera::Ideal, DVec3::ZERO, (DVec3::X, 10.0));
    let found = align(SESSION.0.clone().with_resting(Some(true)), &start);
    let up = |pose: &DMat4| pose.y_axis.truncate().normalize();
    let lean_rad = up(&found.world_from_object).angle_between(up(&SESSION.1.world_from_object));
    assert!(lean_rad.to_degrees() < 0.3, "{lean_rad}");
    assert!(off_mm(&found)[0] < 0.3, "{:?}", off_mm(&found));
}

#[test]
fn receivers_that_are_a_guess_are_laid_under_the_toy() {
    let recorded = SESSION.0.receivers[0].world_from_plane;
    let mut scene = SESSION.0.clone();
    let guess = DMat4::from_translation(DVec3::new(0.0, -0.012, 0.0))
        * DMat4::from_axis_angle(DVec3::new(1.0, 0.0, 0.6).normalize(), 6f64.to_radians());
    scene.receivers[0].world_from_plane = guess * recorded;
    scene.uncertainty.are_receivers_guessed = true;
    let found = align(
        scene,
        &disturbed(Camera::Ideal, DVec3::new(2.0, 1.0, -2.0), (DVec3::Y, 1.5)),
    );
    let scene = found.scene.as_ref().unwrap();
    let laid = scene.receivers[0].world_from_plane;
    let lean_deg = laid
        .y_axis
        .truncate()
        .angle_between(recorded.y_axis.truncate())
        .to_degrees();
    let toy = SESSION.1.world_from_object.w_axis.truncate();
    let height_mm =
        1e3 * laid.inverse().transform_point3(toy).y - 1e3 * recorded.inverse().transform_point3(toy).y;
    assert!(
        lean_deg < 0.5 && height_mm.abs() < 0.5,
        "{lean_deg} degrees, {height_mm} mm"
    );
    assert!(off_mm(&found)[0] < 0.3, "{:?}", off_mm(&found));
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    assert!(!scene.uncertainty.are_receivers_guessed);
}
