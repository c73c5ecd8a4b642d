//! A scene of plain values, without any file: a box on a table under a distant lamp, "photographed"
//! by rays.
//!
//! `cargo run -p app-core --example session_from_code`

mod made;

use std::error::Error;
use std::sync::Arc;

use app_core::frame::FrameInput;
use app_core::glam::{DMat4, DQuat, DVec2, DVec3};
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::scene::{Camera, Intrinsics, Light, Pose, Receiver, Scene, Surface};
use app_core::toy::{NodePose, Toy};
use app_core::{Core, wgpu};
use made::{SIZE_PX, TO_LIGHT};

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let toy = Arc::new(Toy::from_glb("box.glb", &made::box_glb())?);
    let camera = Camera {
        intrinsics: Intrinsics {
            fx_px: 180.0,
            fy_px: 180.0,
            cx_px: 80.0,
            cy_px: 60.0,
        },
        world_from_camera: DMat4::from_translation(DVec3::new(0.05, 0.3, 0.35))
            * DMat4::from_rotation_x(-0.66),
    };
    // The constant part: the toy and its pose, the receivers of its shadow, lights.
    let table = Receiver {
        name: "table".to_owned(),
        world_from_plane: DMat4::IDENTITY,
        half_extent_m: DVec2::splat(1.0),
        surface: Surface::Uniform,
    };
    let lamp = Light::Directional {
        direction_to_light_in_world: TO_LIGHT,
        angular_radius_rad: 0.0,
    };
    let scene = Scene::new(SIZE_PX, Arc::clone(&toy), DMat4::IDENTITY, vec![table]).with_lights(vec![lamp]);
    let node = toy.find_node("box")?;
    let mut turned = toy.authored_transform(node)?.ok_or("authored as a matrix")?;
    turned.rotation = DQuat::from_rotation_y(0.8);

    // The part of each frame: the photograph, the poses of camera and toy in it, and the pose to be
    // shown.
    let pose = Pose::Nodes(Arc::new(NodePose {
        parent_from_node: vec![(node, turned)],
        morph_weights: Vec::new(),
    }));
    let photograph = made::photograph(&camera);
    let input = FrameInput::new(photograph, camera, DMat4::IDENTITY).with_shown_pose(pose);

    let instance = wgpu::Instance::default();
    let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest))?;
    core.set_scene(scene, Preset::Balanced)?;
    for warning in core.frame(&input)?.warnings {
        println!("{warning}");
    }
    assert_ne!(core.read_picture()?.rgba8, input.image.rgba().rgba8);
    Ok(())
}
