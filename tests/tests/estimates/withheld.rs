//! Alignment that must not use the real shadow, so that its prediction can be measured, reads it
//! nowhere: whatever is painted over the shadow in later pictures, the result is the same to the
//! last bit.

use app_core::alignment::{Aligner, Alignment};
use app_core::frame::FrameInput;
use app_core::scene::{Image, Light};
use glam::{DMat4, DQuat, DVec3};
use measure::photographer::{Paint, Shot, World};

const SIZE_PX: [u32; 2] = [480, 270];

/// A world on tiles from two sides, with plates of both; tracked with some error from the second
/// on.
fn shots() -> [Shot; 2] {
    let mut first = World::boxes().resized(SIZE_PX);
    first.grounds[0].paint = Paint::Tiles {
        colors: [DVec3::new(0.50, 0.44, 0.36), DVec3::new(0.22, 0.24, 0.27)],
        side_m: 0.03,
    };
    let mut second = first.clone();
    let camera = &mut second.camera.world_from_camera;
    *camera = DMat4::from_rotation_y(4_f64.to_radians()) * *camera;
    let [mut first, mut second] = [first, second].map(|world| Shot::of(&world).unwrap());
    first.scene.plates.append(&mut second.scene.plates);
    let camera = &mut second.input.camera.world_from_camera;
    *camera *= DMat4::from_rotation_translation(
        DQuat::from_scaled_axis(DVec3::new(0.004, -0.003, 0.002)),
        DVec3::new(1e-3, -5e-4, 1e-3),
    );
    for shot in [&mut first, &mut second] {
        let object = &mut shot.input.world_from_object;
        *object = DMat4::from_translation(DVec3::new(1.5e-3, 5e-4, -1e-3)) * *object;
    }
    [first, second]
}

/// The second picture, aligned after the first with a list of lights that is some degrees off.
fn second(shots: &[Shot; 2], second: &FrameInput, are_shadows_withheld: bool) -> Alignment {
    let [first, _] = shots;
    let mut scene = first.scene.clone();
    for light in &mut scene.lights {
        if let Light::Sphere {
            position_in_world, ..
        } = light
        {
            *position_in_world = DQuat::from_rotation_y(0.06) * *position_in_world;
        }
    }
    let mut aligner = Aligner::new(scene);
    if are_shadows_withheld {
        aligner.withhold_shadows();
    }
    let found = aligner.align(&first.input).unwrap();
    assert!(
        found.lights.is_some() && found.report.pose.unwrap().is_applied,
        "{found:?}"
    );
    aligner.align(second).unwrap()
}

/// A picture with stripes over the pixels that the mask selects.
fn painted(shot: &Shot, is_painted: impl Fn(&[u8]) -> bool) -> FrameInput {
    let mut image = Image::clone(shot.input.image.rgba());
    let mut n_painted = 0;
    let pixels = image
        .rgba8
        .chunks_exact_mut(4)
        .zip(shot.truth.mask.rgba8.chunks_exact(4));
    for (index, (pixel, mask)) in pixels.enumerate() {
        if is_painted(mask) {
            let code = if index / 3 % 2 == 0 { 250 } else { 5 };
            pixel[..3].copy_from_slice(&[code, 255 - code, code]);
            n_painted += 1;
        }
    }
    assert!(n_painted > 200, "{n_painted} pixels");
    shot.input.clone().with_image(image)
}

/// Camera, pose and lights.
fn found(alignment: &Alignment) -> (DMat4, DMat4, Option<Vec<Light>>) {
    (
        alignment.camera.world_from_camera,
        alignment.world_from_object,
        alignment.lights.as_deref().map(<[Light]>::to_vec),
    )
}

#[test]
fn what_is_painted_over_a_withheld_shadow_changes_nothing() {
    let shots = shots();
    let shadow = painted(&shots[1], |mask| mask[3] > 2 && mask[1] == 0);
    let toy = painted(&shots[1], |mask| mask[1] > 0);

    let plain = second(&shots, &shots[1].input, true);
    // The result contains corrections that could have been affected.
    assert_ne!(plain.camera, shots[1].input.camera);
    assert!(plain.report.camera.unwrap().is_applied, "{:?}", plain.report);
    assert_ne!(plain.world_from_object, shots[1].input.world_from_object);

    let over_shadow = second(&shots, &shadow, true);
    assert_eq!(found(&over_shadow), found(&plain));
    assert_eq!(over_shadow.report, plain.report);

    // Paint over the toy has an effect, and so has paint over its shadow if that is not withheld.
    assert_ne!(second(&shots, &toy, true).report, plain.report);
    let read = [&shots[1].input, &shadow].map(|input| second(&shots, input, false));
    assert_ne!(found(&read[0]), found(&read[1]));
}
