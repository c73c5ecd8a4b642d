//! Planes above the table that the toy's shadow may reach are receivers, too; pieces of the table,
//! the floor and distant planes are not.

use std::sync::Arc;

use app_core::app::{ShellEvent, Show, Step, UserAction};
use app_core::camera_frame::FoundPlane;
use glam::{DMat4, DQuat, DVec2, DVec3};

use super::way::{OFF_M, placed};

const STEP: DVec3 = DVec3::new(0.15, 0.02, -0.1);
const RAMP: DVec3 = DVec3::new(-0.1, 0.004, 0.2);

fn plane(id: u64, place: DVec3, tilt_rad: f64) -> FoundPlane {
    FoundPlane {
        id,
        world_from_plane: DMat4::from_rotation_translation(DQuat::from_rotation_x(tilt_rad), place),
        half_extent_m: DVec2::splat(0.04),
    }
}

#[test]
fn planes_above_the_table_are_receivers() {
    let mut person = placed(OFF_M);
    person.act(UserAction::Replace);
    assert_eq!(person.app.step(), Step::PlaceToy);
    let mut frame = person.feed.next(0.033);
    let others = [
        plane(101, STEP, 0.0),
        // Two that were merged into it: they would take all places.
        plane(111, STEP, 0.0),
        plane(112, STEP, 0.0),
        plane(102, STEP * DVec3::new(1.0, 0.2, 1.0), 0.0),
        plane(103, STEP * DVec3::new(1.0, -30.0, 1.0), 0.0),
        plane(104, DVec3::new(2.0, 0.02, 0.0), 0.0),
        plane(105, RAMP, 0.2),
        plane(106, STEP, 1.57),
    ];
    frame.planes = frame
        .planes
        .iter()
        .cloned()
        .chain(others)
        .collect::<Vec<_>>()
        .into();
    person.tell(ShellEvent::Frame(Box::new(frame)));
    person.act(UserAction::Placed);
    person.frames(3);
    let Show::Toy { scene, .. } = person.app.show() else {
        panic!("{:?}", person.app.step());
    };
    let places = scene
        .receivers
        .iter()
        .map(|receiver| receiver.world_from_plane.w_axis.truncate());
    let places: Vec<DVec3> = places.skip(1).collect();
    assert_eq!(places.len(), 2, "{places:?}");
    assert!(places.contains(&STEP) && places.contains(&RAMP), "{places:?}");
    // A plane that is reported later does not change the scene.
    let known = Arc::clone(scene);
    person.frames(3);
    let Show::Toy { scene, .. } = person.app.show() else {
        panic!("{:?}", person.app.step());
    };
    assert!(Arc::ptr_eq(&known, scene));
}
