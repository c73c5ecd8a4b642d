//! Hands, which no plate shows: how high they reach, and the shadow that they cast themselves.

use app_core::alignment::Observer;
use app_core::things::{Mark, Things};
use glam::{DVec3, UVec2};

use super::bundled::SESSION;
use super::things::{
    Found, OVER_LEGS, Rect, SKIN, in_frame_alone, painted_where, pixels_of, shaded, things_in, with_rectangle,
};

/// From above the toy's head down to its feet.
const OVER_ALL: Rect = [UVec2::new(222, 60), UVec2::new(292, 254)];
/// An arm across the toy's shadow, and its own shadow right of it, away from the light.
const ACROSS_SHADOW: Rect = [UVec2::new(340, 210), UVec2::new(380, 360)];
const OWN_SHADOW: Rect = [UVec2::new(380, 210), UVec2::new(400, 360)];
/// Parts of the toy's shadow: in that of the arm, and beyond it.
const IN_BOTH: Rect = [UVec2::new(382, 235), UVec2::new(398, 265)];
const BEYOND: Rect = [UVec2::new(408, 235), UVec2::new(424, 265)];

#[test]
fn a_hand_before_the_feet_alone_is_a_low_one() {
    let top_m = |things: Option<Things>| {
        let fronts = things.unwrap().fronts().to_vec();
        fronts.first().map(|front| -front.distance_m(DVec3::ZERO))
    };
    let of_hand = |rect| top_m(in_frame_alone((SKIN, rect), |_| true).things);
    // The toy is 12 cm high.
    let low_m = of_hand(OVER_LEGS).unwrap();
    assert!((0.01..0.04).contains(&low_m), "{low_m} m");
    assert_eq!(of_hand(OVER_ALL), None);
    // What the plate shows, too, is no hand.
    let (scene, input) = with_rectangle([true, true], OVER_LEGS);
    let things = Observer::default().observed(&scene, &input).unwrap().things;
    assert_eq!(top_m(things), None);
}

#[test]
fn the_toys_shadow_does_not_reach_the_table_in_that_of_a_hand() {
    let [frame, plate] = [SESSION.1.image.rgba(), &*SESSION.0.plates[0].image];
    let dark = shaded(plate, OWN_SHADOW, 0.4);
    let mut casts = frame.clone();
    for at in pixels_of(OWN_SHADOW, frame.width_px) {
        casts.rgba8[4 * at..4 * at + 3].copy_from_slice(&dark.rgba8[4 * at..4 * at + 3]);
    }
    let kept = [&casts, frame].map(|image| {
        let things = things_in(painted_where(image, (SKIN, ACROSS_SHADOW), |_| true));
        [IN_BOTH, BEYOND].map(|rect| {
            let things = things.clone();
            Found { things, rect }.part(Mark::Thing)
        })
    });
    let [[in_both, beyond], [in_the_toys, _]] = kept;
    assert!(
        in_both > 0.9 && beyond < 0.1 && in_the_toys < 0.1,
        "{kept:.2?} of both parts, with and without the hand's shadow"
    );
}
