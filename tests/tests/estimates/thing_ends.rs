//! Where things end beside surfaces that neither light nor colours tell from them.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::scene::Image;
use app_core::things::Mark;
use glam::UVec2;

use super::things::{Found, OVER_LEGS, Rect, SIDE, painted_where, with_rectangle};

/// Beside the thing, away from toy and shadow.
const PATCH: Rect = [UVec2::new(150, 222), UVec2::new(222, 254)];

/// A patch of the table in a colour that it has nowhere else, as a table far behind a toy has.
#[test]
fn a_thing_before_the_toy_ends_at_a_patch_in_no_known_colour() {
    let (mut scene, input) = with_rectangle([true, true], OVER_LEGS);
    let with_patch = |image: &Image| Arc::new(painted_where(image, (SIDE, PATCH), |_| true));
    scene.plates[0].image = with_patch(&scene.plates[0].image);
    let input = input.clone().with_image(with_patch(input.image.rgba()));
    let things = Observer::default().observed(&scene, &input).unwrap().things;
    let rect = OVER_LEGS;
    Found { things, rect }.assert_whole(Mark::BeforeToy);
}
