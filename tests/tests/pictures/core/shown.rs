//! The toy is shown elsewhere than where it stands.

use std::sync::Arc;

use app_core::preset::Preset;
use app_core::scene::Pose;
use app_core::toy::{NodePose, Trs};
use glam::{DMat4, DQuat, DVec3};

use crate::core::bundled::{core, first_input, picture_of, scene};

/// 20 mm beside and turned by 15 degrees about where it stands.
fn beside(world_from_object: &DMat4) -> DMat4 {
    let at = world_from_object.w_axis.truncate();
    let motion = DMat4::from_translation(at + DVec3::new(0.02, 0.0, 0.005))
        * DMat4::from_rotation_y(15_f64.to_radians())
        * DMat4::from_translation(-at);
    motion * *world_from_object
}

#[test]
fn a_place_beside_is_the_same_as_a_root_that_is_moved_there() {
    let mut core = core();
    let (scene, first) = (scene(), first_input());
    let world_from_shown = beside(&first.world_from_object);
    let by_place = first
        .clone()
        .with_shown_pose(Pose::Authored)
        .with_world_from_shown(Some(world_from_shown));
    let root = scene.toy.find_node("root").unwrap();
    let authored = scene.toy.authored_transform(root).unwrap().unwrap();
    let authored =
        DMat4::from_scale_rotation_translation(authored.scale, authored.rotation, authored.translation);
    let moved = first.world_from_object.inverse() * world_from_shown * authored;
    let (scale, rotation, translation) = moved.to_scale_rotation_translation();
    let by_root = first.clone().with_shown_pose(Pose::Nodes(Arc::new(NodePose {
        parent_from_node: vec![(
            root,
            Trs {
                translation,
                rotation: DQuat::normalize(rotation),
                scale,
            },
        )],
        ..NodePose::default()
    })));
    let in_place = first.with_shown_pose(Pose::Authored);
    for preset in Preset::ALL {
        let mut picture = |input| {
            core.set_scene(scene.clone(), *preset).unwrap();
            picture_of(&mut core, input)
        };
        let [place, root, still] = [&by_place, &by_root, &in_place].map(&mut picture);
        let differing = |other: &[u8]| {
            let pairs = place.iter().zip(other);
            pairs.filter(|(a, b)| a.abs_diff(**b) > 1).count()
        };
        let [near, far] = [&root, &still].map(|other| differing(other));
        // Positions are rounded to 32 bits on two ways, which shows in some pixels at an edge.
        assert!(100 * near < far, "{preset}: {near} of {far}");
    }
}

#[test]
fn the_physical_pose_at_another_place_does_not_pass_through() {
    let mut core = core();
    let posed = scene();
    let physical = first_input().with_shown_pose(posed.physical_pose.clone());
    let place = physical.world_from_object;
    core.set_scene(posed, Preset::Balanced).unwrap();
    let mut is_made = |place| {
        let input = physical.clone().with_world_from_shown(place);
        core.frame(&input).unwrap().region.is_some()
    };
    let made = [None, Some(place), Some(beside(&place))].map(&mut is_made);
    assert_eq!(made, [false, false, true]);
}

#[test]
fn a_place_that_is_no_similarity_is_refused_by_name() {
    let squeezed = DMat4::from_scale(DVec3::new(1.0, 0.5, 1.0));
    let input = first_input().with_world_from_shown(Some(squeezed));
    let refused = input.check().unwrap_err().to_string();
    assert!(refused.contains("world_from_shown"), "{refused}");
}
