//! Masks of two overlapping shadows, and of a penumbra between them.

use glam::{DVec4, UVec2};
use reference::census::seen_sets;
use reference::eligible::masks;
use reference::raster::Raster;
use reference::sets::LightSet;

const SIZE: UVec2 = UVec2::new(60, 21);
const MARGIN_PX: i32 = 2;

/// The first light is hidden from column 10 to 40, the second from 30 to 50, after two columns of
/// penumbra.
fn visibility(at: UVec2) -> DVec4 {
    let first = if (10..40).contains(&at.x) { 0.0 } else { 1.0 };
    let second = match at.x {
        28..30 => 0.5,
        30..50 => 0.0,
        // Invisible to the eye.
        50..52 => 0.995,
        _ => 1.0,
    };
    DVec4::new(first, second, 0.0, 1.0)
}

#[test]
fn umbras_are_kept_apart_by_lights_and_away_from_edges() {
    let is_toy = Raster::from_fn(SIZE, |at| at.x >= 20 && at.x < 40 && at.y >= 15);
    let (eligible, shadow) = masks(&is_toy, &Raster::from_fn(SIZE, visibility), 2, MARGIN_PX);
    let [none, first, second, both] = [0, 1, 2, 3].map(LightSet);
    for x in 0..SIZE.x {
        let expected = match x {
            12..26 => first,
            32..38 => both,
            42..48 => second,
            _ => none,
        };
        assert_eq!(eligible.at(UVec2::new(x, 5)), expected, "column {x}");
        assert_eq!(shadow.at(UVec2::new(x, 5)), (10..50).contains(&x), "column {x}");
    }
    // The toy covers the lower rows and is excluded with a margin.
    assert_eq!(eligible.at(UVec2::new(30, 18)), none);
    assert_eq!(eligible.at(UVec2::new(34, 13)), none);
    assert_eq!(eligible.at(UVec2::new(34, 12)), both);
    assert_eq!(seen_sets(&eligible), [first, second, both]);
}

#[test]
fn channels_of_no_light_do_not_count() {
    let is_toy = Raster::from_fn(SIZE, |_| false);
    let (eligible, shadow) = masks(&is_toy, &Raster::from_fn(SIZE, visibility), 1, MARGIN_PX);
    assert_eq!(seen_sets(&eligible), [LightSet(1)]);
    assert!(!shadow.at(UVec2::new(45, 5)));
}
