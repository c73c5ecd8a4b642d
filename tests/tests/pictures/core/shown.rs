//! Showing the toy in a place other than its own.

use std::sync::Arc;

use app_core::preset::Preset;
use app_core::scene::{Pose, Shown};
use app_core::toy::{NodePose, Trs};
use glam::{DMat4, DQuat, DVec3};

use crate::core::bundled::{core, first_input, picture_of, scene};

/// 20 mm aside and turned by 15 degrees about the toy's own position.
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
        // Positions are rounded to 32 bits in two ways, which is visible in some pixels at an edge.
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

/// Frames of a film may be made in any order, and by different programs.
#[test]
fn a_frame_of_a_film_depends_on_no_other() {
    let mut core = core();
    let (scene, first) = (scene(), first_input());
    let clip = first.shown_pose.clip().unwrap();
    let moment = |time_secs| Pose::Clip { clip, time_secs };
    let toy = &scene.toy;
    let between = toy.blended(&moment(0.3), &moment(1.4), 0.5).unwrap();
    let film = [moment(0.2), between, Pose::Authored, moment(1.2)].map(|pose| Shown {
        pose,
        world_from_shown: Some(beside(&first.world_from_object)),
    });
    let known = scene.clone().with_film(film.clone());
    for preset in [Preset::Balanced, Preset::Paper] {
        let mut made = |order: &[usize]| -> Vec<Vec<u8>> {
            core.set_scene(known.clone(), preset).unwrap();
            let shown = order.iter().map(|index| &film[*index]);
            let inputs = shown.map(|shown| {
                let input = first.clone().with_shown_pose(shown.pose.clone());
                input.with_world_from_shown(shown.world_from_shown)
            });
            inputs.map(|input| picture_of(&mut core, &input)).collect()
        };
        let forth = made(&[0, 1, 2, 3]);
        let mut back = made(&[3, 2, 1, 0]);
        back.reverse();
        assert!(forth == back, "{preset}");
        assert!(forth[1..2] == made(&[1]), "{preset}");
        assert!(forth[0] != forth[1], "{preset}");
    }
}

#[test]
fn a_place_that_is_no_similarity_is_refused_by_name() {
    let squeezed = DMat4::from_scale(DVec3::new(1.0, 0.5, 1.0));
    let input = first_input().with_world_from_shown(Some(squeezed));
    let refused = input.check().unwrap_err().to_string();
    assert!(refused.contains("world_from_shown"), "{refused}");
}
