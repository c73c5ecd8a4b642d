//! Things are found beside a plate of another exposure.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::things::Mark;
use glam::UVec2;

use super::things::{Found, OVER_LEGS, shaded, with_rectangle};

/// Exposure of the plate over that of the frame: one surface differs by a dozen codes.
const EXPOSURE: f32 = 0.8;

#[test]
fn a_thing_before_the_toy_is_found_beside_a_darker_plate() {
    let (mut scene, input) = with_rectangle([true, true], OVER_LEGS);
    let plate = &scene.plates[0].image;
    let whole = [UVec2::ZERO, UVec2::new(plate.width_px, plate.height_px)];
    scene.plates[0].image = Arc::new(shaded(plate, whole, EXPOSURE));
    let things = Observer::default().observed(&scene, &input).unwrap().things;
    let rect = OVER_LEGS;
    Found { things, rect }.assert_whole(Mark::BeforeToy);
}
