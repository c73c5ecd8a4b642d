//! The drawn lights: the hemisphere's picture is brightest in the light's direction, and a ray
//! points to it.

use app_core::alignment::LightSearch;
use app_core::frame::FrameInput;
use app_core::scene::{Image, Scene};
use app_core::session::Session;
use desk::false_color::ERROR_RAMP;
use desk::gizmo::{Gizmo, hemisphere, rays};
use glam::{DQuat, DVec2, DVec3};

/// A colour that occurs in no picture and no ramp.
const MARK: [u8; 3] = [1, 254, 2];

fn session() -> (Scene, FrameInput) {
    let session = harness::bundled_session();
    (
        session.scene().clone(),
        FrameInput::from(&session.frame(0).unwrap()),
    )
}

/// Mean position of the pixels of a colour.
fn middle_of(picture: &Image, color: [u8; 3]) -> DVec2 {
    let pixels = picture.rgba8.as_chunks::<4>().0.iter().enumerate();
    let places = pixels.filter(|(_, pixel)| pixel[..3] == color);
    let places = places.map(|(index, _)| {
        let width = picture.width_px as usize;
        DVec2::new((index % width) as f64, (index / width) as f64)
    });
    let (sum, n) = places.fold((DVec2::ZERO, 0.0), |(sum, n), at| (sum + at, n + 1.0));
    assert!(n > 0.0);
    sum / n
}

#[test]
fn a_hemisphere_is_brightest_where_the_light_is() {
    let (scene, input) = session();
    let search = LightSearch::of(&scene, &input).unwrap().unwrap();
    let light = Gizmo::listed(&scene, &input)[0];
    let brightest = middle_of(
        &hemisphere(&search, &input.camera, &[]),
        ERROR_RAMP[ERROR_RAMP.len() - 1],
    );
    let off_px = |turn_deg: f64| {
        let mut turned = light;
        let turn = DQuat::from_axis_angle(DVec3::Y, f64::to_radians(turn_deg));
        turned.seen.direction_in_world = turn * light.seen.direction_in_world;
        let drawn = hemisphere(&search, &input.camera, &[(turned, MARK)]);
        middle_of(&drawn, MARK).distance(brightest)
    };
    // Neighbouring directions are some 25 pixels apart.
    assert!(off_px(0.0) < 25.0, "{} px", off_px(0.0));
    assert!(off_px(60.0) > 60.0, "{} px", off_px(60.0));
}

#[test]
fn a_ray_points_to_its_light() {
    let (scene, input) = session();
    let mut light = Gizmo::listed(&scene, &input)[0];
    let camera_from_world = input.camera.world_from_camera.inverse();
    let drawn = |light: &Gizmo| {
        let mut picture = Image::clone(input.image.rgba());
        rays(&mut picture, (&scene, &input), &[*light], MARK);
        middle_of(&picture, MARK)
    };
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).unwrap();
    let middle = 0.5 * (bounds.min + bounds.max).as_dvec3();
    let toy = input.world_from_object.transform_point3(middle);
    let seen = |place: DVec3| {
        let pixel = input
            .camera
            .intrinsics
            .pixel_of(camera_from_world.transform_point3(place));
        pixel.unwrap()
    };
    let towards = seen(toy + 0.01 * light.seen.direction_in_world) - seen(toy);
    let ray = drawn(&light) - seen(toy);
    assert!(ray.angle_to(towards).abs() < 0.05 && ray.length() > 10.0, "{ray}");
    light.seen.direction_in_world *= -1.0;
    assert!((drawn(&light) - seen(toy)).dot(towards) < 0.0);
}
