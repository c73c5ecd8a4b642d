//! Where things end beside surfaces that neither light nor colours tell from them.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::scene::Image;
use app_core::things::Mark;
use glam::UVec2;

use super::things::{Found, OVER_LEGS, Rect, SIDE, painted_where, with_rectangle};

/// Stripes of the table beside the thing, away from toy and shadow, in colours that it has nowhere else, as a table far
/// behind a toy has: each is too narrow for a place's common colour.
const STRIPES: [([u8; 3], Rect); 3] = [
    (SIDE, [UVec2::new(178, 222), UVec2::new(222, 233)]),
    ([210, 190, 60], [UVec2::new(178, 233), UVec2::new(222, 244)]),
    ([90, 40, 170], [UVec2::new(178, 244), UVec2::new(222, 254)]),
];

#[test]
fn a_thing_before_the_toy_ends_at_colours_that_nothing_tells_from_its_own() {
    let (mut scene, input) = with_rectangle([true, true], OVER_LEGS);
    let striped = |image: &Image| {
        let with = |image: Image, stripe| painted_where(&image, stripe, |_| true);
        Arc::new(STRIPES.into_iter().fold(image.clone(), with))
    };
    scene.plates[0].image = striped(&scene.plates[0].image);
    let input = input.clone().with_image(striped(input.image.rgba()));
    let things = Observer::default().observed(&scene, &input).unwrap().things;
    let rect = OVER_LEGS;
    Found { things, rect }.assert_whole(Mark::BeforeToy);
}
