//! Filtered terms in known cases: a constant, a single term, a step.

use glam::{DVec3, DVec4, UVec2};
use reference::box_filter::{box_sums, mean};
use reference::raster::{Raster, texels_of};

const SIZE: UVec2 = UVec2::new(61, 37);
const RADIUS_PX: u32 = 5;

#[test]
fn constant_stays_and_what_has_no_term_does_not_count() {
    let value = DVec3::new(0.3, 0.5, 0.7);
    // A ragged shadow: two thirds of the left half.
    let terms = Raster::from_fn(SIZE, |at| ((at.x + at.y) % 3 > 0 && at.x < 30).then_some(value));
    let sums = box_sums(&terms, RADIUS_PX);
    for texel in texels_of(SIZE) {
        let mean = mean(sums.at(texel));
        // A square extends beyond the shadow's edge by its radius.
        assert_eq!(mean.is_some(), texel.x < 30 + RADIUS_PX, "{texel}");
        assert!(
            mean.is_none_or(|mean| (mean - value).abs().max_element() < 1e-12),
            "{texel}"
        );
    }
}

#[test]
fn single_term_is_spread_over_its_square() {
    for place in [UVec2::new(30, 18), UVec2::new(2, 36), UVec2::ZERO] {
        let value = DVec3::new(0.2, 0.4, 0.8);
        let terms = Raster::from_fn(SIZE, |at| (at == place).then_some(value));
        let sums = box_sums(&terms, RADIUS_PX);
        for texel in texels_of(SIZE) {
            let is_near = texel.as_ivec2().chebyshev_distance(place.as_ivec2()) <= RADIUS_PX;
            let expected = if is_near { value.extend(1.0) } else { DVec4::ZERO };
            assert_eq!(sums.at(texel), expected, "{place} {texel}");
        }
    }
}

#[test]
fn step_becomes_a_ramp_as_wide_as_the_box() {
    let terms = Raster::from_fn(SIZE, |at| Some(DVec3::splat(if at.x < 30 { 0.0 } else { 1.0 })));
    let sums = box_sums(&terms, RADIUS_PX);
    for x in 15..45_u32 {
        let expected = ((f64::from(x) - 24.0) / 11.0).clamp(0.0, 1.0);
        let actual = mean(sums.at(UVec2::new(x, 18))).unwrap().x;
        assert!(
            (actual - expected).abs() < 1e-12,
            "column {x}: {actual}, not {expected}"
        );
    }
}
