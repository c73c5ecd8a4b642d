//! Searches with a known result: for one eligible texel, for a whole ring of them, and for none.

use glam::{DVec2, DVec3, IVec2, UVec2};
use reference::raster::Raster;
use reference::search::{Found, Rings, Start, search, term};
use reference::sets::LightSet;

const SIZE: UVec2 = UVec2::new(61, 37);
const RINGS: Rings = Rings {
    step_px: 2.0,
    n_directions: 16,
    n_rings: 6,
};

/// The set of the first light alone.
const FIRST: LightSet = LightSet(1);

fn only(eligible: &[IVec2]) -> Raster<LightSet> {
    Raster::from_fn(SIZE, |at| {
        let is_eligible = eligible.contains(&at.as_ivec2());
        if is_eligible { FIRST } else { LightSet::default() }
    })
}

fn search_first(eligible: &Raster<LightSet>, at_px: DVec2, rings: &Rings) -> Found {
    let start = Start {
        set: FIRST,
        sources_px: vec![at_px],
    };
    search(eligible, &[FIRST], &start, rings)
}

#[test]
fn lone_texel_is_found_on_the_ring_that_it_lies_on() {
    let start = IVec2::new(30, 18);
    // Even rings have candidates along the axes.
    for ring in [2, 4, 6] {
        for toward in [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y] {
            let texel = start + toward * 2 * i32::try_from(ring).unwrap();
            let found = search_first(&only(&[texel]), start.as_dvec2() + 0.5, &RINGS);
            let expected = Found {
                texel: Some(texel),
                n_taps: 16 * ring,
            };
            assert_eq!(found, expected, "ring {ring} toward {toward}");
        }
    }
}

#[test]
fn closest_of_a_ring_wins_and_an_inner_ring_before_it() {
    // The first ring's four candidates, starting at (22.3, 21.9); the point is closer to those on
    // the left.
    let at_px = DVec2::new(20.9, 20.5);
    let rings = Rings {
        n_directions: 4,
        ..RINGS
    };
    let [right, left] = [IVec2::new(22, 21), IVec2::new(19, 21)];
    let on_second = IVec2::new(24, 20);
    for (eligible, expected, n_taps) in [
        (&[right, left][..], left, 4),
        (&[right], right, 4),
        (&[right, on_second], right, 4),
        (&[on_second], on_second, 8),
    ] {
        let found = search_first(&only(eligible), at_px, &rings);
        assert_eq!(
            (found.texel, found.n_taps),
            (Some(expected), n_taps),
            "{eligible:?}"
        );
    }
}

#[test]
fn eligible_texel_costs_no_tap_and_nothing_in_reach_costs_all() {
    let own = search_first(&only(&[IVec2::new(7, 8)]), DVec2::new(7.99, 8.01), &RINGS);
    assert_eq!((own.texel, own.n_taps), (Some(IVec2::new(7, 8)), 0));
    let far = only(&[IVec2::new(7 + 20, 8)]);
    // Candidates beyond the border are tested, too, and are not eligible.
    let nothing = search_first(&far, DVec2::new(7.5, 8.5), &RINGS);
    assert_eq!((nothing.texel, nothing.n_taps), (None, 96));
}

/// From the corner, the farthest texel is on the ring just before the opposite corner; from the
/// centre it is half as far.
#[test]
fn no_ring_is_searched_beyond_the_region() {
    let rings = Rings {
        n_rings: 1000,
        ..RINGS
    };
    // The diagonal is 71.3 px; from 10 px beyond the centre of the left side, the far corners are
    // 73.4 px away.
    for (at_px, n_rings) in [
        (DVec2::ZERO, 35),
        (SIZE.as_dvec2(), 35),
        (0.5 * SIZE.as_dvec2(), 17),
        (DVec2::new(-10.0, 18.5), 36),
    ] {
        let nothing = search_first(&only(&[]), at_px, &rings);
        assert_eq!((nothing.texel, nothing.n_taps), (None, 16 * n_rings), "{at_px}");
    }
}

#[test]
fn term_is_the_shadow_over_the_light_or_its_colour() {
    let shade = DVec3::new(0.4, 0.5, 0.6);
    for plate in [DVec3::splat(0.8), DVec3::new(0.1, 0.9, 0.3)] {
        let ratio = term(shade * plate, plate, true);
        assert!((ratio - shade).abs().max_element() < 1e-12, "{ratio}");
        assert_eq!(term(shade, plate, false), shade);
    }
    let black = term(DVec3::splat(0.1), DVec3::new(0.0, 0.2, 0.0), true);
    assert!(
        (black - DVec3::new(1.0, 0.5, 1.0)).abs().max_element() < 1e-12,
        "{black}"
    );
}

/// Texels of three sets around a texel in the new shadows of both lights.
#[test]
fn overlap_is_sampled_where_the_same_lights_overlap() {
    let [first, second, both] = [&[0][..], &[1], &[0, 1]].map(LightSet::of);
    let at = |x| IVec2::new(x, 18);
    let scene = |with: &[(i32, LightSet)]| {
        Raster::from_fn(SIZE, |texel| {
            let here = with.iter().find(|(x, _)| at(*x) == texel.as_ivec2());
            here.map(|(_, set)| *set).unwrap_or_default()
        })
    };
    let centre = at(30).as_dvec2() + 0.5;
    let found = |with: &[(i32, LightSet)], set: LightSet| {
        let start = Start {
            set,
            sources_px: vec![centre; set.lights().count()],
        };
        let seen: Vec<_> = with.iter().map(|(_, set)| *set).collect();
        search(&scene(with), &seen, &start, &RINGS)
    };
    // The overlap lies behind both shadows, on the third ring of those with candidates along the
    // axis.
    let all = [(34, first), (26, second), (42, both)];
    assert_eq!(found(&all, both).texel, Some(at(42)));
    assert_eq!(found(&all, both).n_taps, 2 * 16 * 6, "two sources, six rings");
    assert_eq!(found(&all, first).texel, Some(at(34)));
    // No overlap is visible: the closest of the two shadows is used, but not the one with an
    // additional light.
    assert_eq!(found(&[(38, first), (26, second)], both).texel, Some(at(26)));
    let third = LightSet::of(&[0, 1, 2]);
    assert_eq!(found(&[(26, third), (38, first)], both).texel, Some(at(38)));
    // Only the overlap is visible: a hole would be worse.
    assert_eq!(found(&[(26, both)], first).texel, Some(at(26)));
    // The overlap is visible, but out of reach.
    assert_eq!(found(&[(60, both), (38, first)], both).texel, Some(at(38)));
    // An empty set of eligible texels has no cost.
    let nothing = Found {
        texel: None,
        n_taps: 0,
    };
    assert_eq!(found(&[], both), nothing);
}
