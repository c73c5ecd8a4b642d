//! A toy that leaves the picture and comes back, while another pose of it is shown: targets keep
//! their size for it.

use std::sync::Arc;

use app_core::Core;
use app_core::frame::{FrameInput, Warning};
use app_core::preset::Preset;
use app_core::scene::{Camera, Pose};
use app_core::toy::{NodePose, Trs};
use app_pipeline::core::inspect::Inspect;
use glam::{DMat4, DQuat, DVec3};
use measure::ball::{SCREEN_PX, ball, phone, scene_of};

/// Turn to the left after which the real toy is beyond the picture's right side, and the shown one
/// still in it.
const TURN_RAD: f64 = 0.58;

#[test]
fn a_toy_that_comes_back_finds_its_targets() {
    let (scene, input) = scene_of(ball(24, 13), 1, (phone(), SCREEN_PX));
    let aside = Trs {
        translation: DVec3::new(-0.25, 0.0, 0.0),
        rotation: DQuat::IDENTITY,
        scale: DVec3::ONE,
    };
    let shown = NodePose {
        parent_from_node: vec![(scene.toy.find_node("toy").unwrap(), aside)],
        morph_weights: Vec::new(),
    };
    let seen = input.with_shown_pose(Pose::Nodes(Arc::new(shown)));
    let left = seen.clone().with_camera(Camera {
        world_from_camera: seen.camera.world_from_camera * DMat4::from_rotation_y(TURN_RAD),
        ..seen.camera
    });
    let mut core = Core::counting();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let mut made_bytes = |input: &FrameInput, is_out: bool| {
        let report = core.frame(input).unwrap();
        assert!(report.region.is_some());
        let warns = report.warnings.contains(&Warning::ToyOutOfPicture);
        assert_eq!(warns, is_out, "{:?}", report.warnings);
        core.memory().made_bytes
    };
    // Until the targets are as large as either view requires.
    for _ in 0..2 {
        made_bytes(&seen, false);
        made_bytes(&left, true);
    }
    let before = made_bytes(&seen, false);
    assert_eq!(made_bytes(&left, true), before, "the toy leaves");
    assert_eq!(made_bytes(&seen, false), before, "the toy comes back");
}
