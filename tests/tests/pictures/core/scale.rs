//! A world in other units, or of another size, results in the same picture.

use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::{Camera, Light, Plate, Scene};
use glam::DMat4;
use harness::compare::Pair;

use crate::core::bundled::{core, first_input, scene};

fn moved(rigid: &DMat4, scale: f64) -> DMat4 {
    let mut moved = *rigid;
    moved.w_axis = (scale * rigid.w_axis.truncate()).extend(1.0);
    moved
}

fn camera(camera: &Camera, scale: f64) -> Camera {
    Camera {
        world_from_camera: moved(&camera.world_from_camera, scale),
        ..*camera
    }
}

fn light(light: &Light, scale: f64) -> Light {
    match *light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => Light::Sphere {
            position_in_world: scale * position_in_world,
            radius_m: scale * radius_m,
        },
        directional @ Light::Directional { .. } => directional,
    }
}

fn scaled(scale: f64) -> (Scene, FrameInput) {
    let (mut scene, input) = (scene(), first_input());
    for receiver in &mut scene.receivers {
        receiver.world_from_plane = moved(&receiver.world_from_plane, scale);
        receiver.half_extent_m *= scale;
    }
    let plates = scene.plates.iter().map(|plate| Plate {
        camera: camera(&plate.camera, scale),
        image: plate.image.clone(),
    });
    let plates = plates.collect();
    let world_from_object = DMat4::from_scale(glam::DVec3::splat(scale)) * scene.world_from_object;
    let lights = scene.lights.iter().map(|one| light(one, scale)).collect();
    let scene = scene
        .with_world_from_object(world_from_object)
        .with_lights(lights)
        .with_plates(plates);
    let camera = camera(&input.camera, scale);
    let input = input
        .with_camera(camera)
        .with_world_from_object(world_from_object);
    (scene, input)
}

/// Some ten of 14,400 pixels have a sample that falls on the other side of an edge.
#[test]
fn the_scale_of_the_world_changes_nothing() {
    let mut core = core();
    let pictures = [1.0, 1e-3, 0.03, 1e3].map(|scale| {
        let (scene, input) = scaled(scale);
        core.set_scene(scene, Preset::Balanced).unwrap();
        core.frame(&input).unwrap();
        (scale, core.read_picture().unwrap())
    });
    let (_, expected) = &pictures[0];
    for (scale, actual) in &pictures[1..] {
        let share = Pair { expected, actual }.difference().unwrap().share_above(1.0);
        assert!(share < 2e-3, "{scale}: {share}");
    }
}
