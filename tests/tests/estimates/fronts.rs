//! Things before the toy that stand on the table: where they end, and in which light they are found.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::things::{Front, Mark, Things};
use glam::{DVec2, DVec3, UVec2};

use super::bundled::SESSION;
use super::things::{Found, OVER_LEGS, Rect, shaded, with_rectangle};

/// A post beside the toy, whose foot is nearer than the toy, in a part of the shadow.
const POST: Rect = [UVec2::new(340, 200), UVec2::new(372, 350)];
/// As far down, but wider than it is high.
const LYING: Rect = [UVec2::new(330, 240), UVec2::new(500, 350)];
/// A post whose foot is behind the toy's middle.
const BEHIND: Rect = [UVec2::new(375, 110), UVec2::new(405, 236)];

fn seen(rect: Rect) -> (Found, Vec<Front>) {
    let found = Found::of([true, true], rect);
    let fronts = found.things.as_ref().map(|things| things.fronts().to_vec());
    (found, fronts.unwrap_or_default())
}

/// The point on the table at a place in the picture.
fn on_table(input: &FrameInput, px: DVec2) -> DVec3 {
    let world_from_camera = input.camera.world_from_camera;
    let eye = world_from_camera.w_axis.truncate();
    let ray = world_from_camera.transform_vector3(input.camera.intrinsics.ray(px));
    eye - eye.y / ray.y * ray
}

#[test]
fn what_stands_nearer_than_the_toy_is_before_it() {
    let (post, fronts) = seen(POST);
    assert!(
        post.part(Mark::BeforeToy) > 0.9,
        "{:.2}",
        post.part(Mark::BeforeToy)
    );
    let [side, top] = fronts[..] else {
        panic!("{fronts:?}");
    };
    let input = &SESSION.1;
    let foot = on_table(input, DVec2::new(356.0, 350.0));
    let toy = input.world_from_object.w_axis.truncate();
    let eye = input.camera.world_from_camera.w_axis.truncate();
    let sides_m = [foot, toy, eye].map(|point| side.distance_m(point));
    assert!(
        sides_m[0].abs() < 0.004 && sides_m[1] < -0.03 && sides_m[2] > 0.1,
        "{sides_m:.3?} m before the side"
    );
    // A ray to the upper end over one to the foot, less what is taken for the top's depth.
    let upper = on_table(input, DVec2::new(356.0, 200.0));
    let upright_m = eye.y * (1.0 - (foot - eye).with_y(0.0).length() / (upper - eye).with_y(0.0).length());
    let top_m = -top.distance_m(DVec3::ZERO);
    assert!(
        (0.6 * upright_m..upright_m).contains(&top_m),
        "{top_m} m of {upright_m}"
    );
}

#[test]
fn what_lies_or_stands_behind_the_toy_is_not_before_it() {
    for rect in [LYING, BEHIND] {
        let (thing, fronts) = seen(rect);
        let parts = [Mark::Thing, Mark::BeforeToy].map(|mark| thing.part(mark));
        assert!(parts[0] > 0.8 && parts[1] == 0.0, "{parts:.2?} of {rect:?}");
        assert_eq!(fronts, []);
    }
}

#[test]
fn a_thing_before_the_toy_may_be_in_another_light_than_in_the_plate() {
    let before = |light| {
        let (scene, input) = with_rectangle([true, true], OVER_LEGS);
        let image = shaded(input.image.rgba(), OVER_LEGS, light);
        let input = input.with_image(Arc::new(image));
        let things = Observer::default().observed(&scene, &input).unwrap().things;
        things.map_or(0, |things: Things| things.count(Mark::BeforeToy))
    };
    let counts = [1.0, 0.8].map(before);
    assert!(
        counts[1] as f64 > 0.9 * counts[0] as f64 && counts[0] > 1000,
        "{counts:?}"
    );
}
