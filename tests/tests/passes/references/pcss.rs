//! The soft edge of a level half plane under a light.

use glam::{DVec2, DVec4, UVec2};
use reference::pcss::{Softness, soft_visibility};
use reference::raster::Raster;

use crate::references::flat;
use crate::references::visibility::disc_beyond;

const SIZE: UVec2 = UVec2::new(161, 61);
/// The light's disc, its height and the half plane's: R h / (d - h) is 20 pixels.
const RADIUS_M: f64 = 0.05;
const LIGHT_M: f64 = 1.0;
const HEIGHT_M: f64 = 0.8;
const PENUMBRA_PX: f64 = 20.0;
/// First column without shadow.
const EDGE: u32 = 80;

fn bulb() -> Softness {
    Softness {
        light: DVec4::new(0.0, LIGHT_M, 0.0, 1.0),
        light_radius: RADIUS_M,
        tallest_m: HEIGHT_M,
        n_blocker_taps: 256,
        n_filter_taps: 4096,
    }
}

/// Visibility along the middle row, and each texel's distance beyond the edge.
fn across(softness: &Softness) -> impl Iterator<Item = (f64, f64)> {
    let region = flat::region(SIZE, vec![softness.light]);
    let heights_m = Raster::from_fn(SIZE, |at| (at.x < EDGE).then_some(HEIGHT_M));
    // Slanted kernels stay within the region.
    (30..140_u32).map(move |x| {
        let beyond_px = f64::from(x) + 0.5 - f64::from(EDGE);
        (
            beyond_px,
            soft_visibility(&heights_m, &region, &[*softness], UVec2::new(x, 30)),
        )
    })
}

#[test]
fn penumbra_of_an_edge_follows_the_circle_segment() {
    for (beyond_px, actual) in across(&bulb()) {
        let expected = 1.0 - disc_beyond(beyond_px / PENUMBRA_PX);
        // A tap reads a whole texel: its error is at most half a texel of a segment as long as the
        // disc is wide.
        let bound = 0.5 / PENUMBRA_PX * 2.0 / std::f64::consts::PI + 2e-3;
        assert!(
            (actual - expected).abs() < bound,
            "{beyond_px} px: {actual}, not {expected}"
        );
    }
}

#[test]
fn umbra_is_dark_and_everything_beyond_the_penumbra_is_lit() {
    let is_outside = |(beyond_px, _): &(f64, f64)| beyond_px.abs() > PENUMBRA_PX + 1.0;
    for (beyond_px, actual) in across(&bulb()).filter(is_outside) {
        let expected = if beyond_px < 0.0 { 0.0 } else { 1.0 };
        assert!((actual - expected).abs() < 1e-12, "{beyond_px} px: {actual}");
    }
}

#[test]
fn point_light_keeps_the_edge_within_a_pixel() {
    let point = Softness {
        light_radius: 0.0,
        ..bulb()
    };
    for (beyond_px, actual) in across(&point) {
        let expected = if beyond_px < 0.0 { 0.0 } else { 1.0 };
        assert!((actual - expected).abs() < 1e-12, "{beyond_px} px: {actual}");
    }
}

#[test]
fn light_lower_than_the_toys_top_keeps_its_penumbra() {
    // The edge is below the light, the toy's top above it.
    let tall = Softness {
        tallest_m: 1.2,
        ..bulb()
    };
    let near_edge = across(&tall).filter(|(beyond_px, _)| beyond_px.abs() < 0.5 * PENUMBRA_PX);
    for (beyond_px, visibility) in near_edge {
        assert!(
            visibility > 0.05 && visibility < 0.95,
            "{beyond_px} px: {visibility}"
        );
    }
}

#[test]
fn disc_across_a_slanted_ray_is_longer_along_it() {
    let low = Softness {
        light: DVec4::new(0.0, 0.5, 0.75_f64.sqrt(), 0.0),
        ..bulb()
    };
    // The elevation is the same at one point of the receiver.
    let near = Softness {
        light: DVec4::new(0.3, 0.5, 0.75_f64.sqrt(), 1.0),
        ..bulb()
    };
    for (softness, in_plane) in [(low, DVec2::new(3.0, 7.0)), (near, DVec2::new(0.3, 0.0))] {
        for (disc, expected) in [(DVec2::X, DVec2::X), (DVec2::Y, 2.0 * DVec2::Y)] {
            let actual = softness.slanted(disc, in_plane);
            assert!((actual - expected).length() < 1e-12, "{disc}: {actual}");
        }
    }
    let under = DVec2::new(0.3, 0.75_f64.sqrt());
    assert_eq!(near.slanted(DVec2::X, under), DVec2::X);
}

#[test]
fn penumbra_grows_with_height_over_what_is_left_to_the_light() {
    let bulb = bulb();
    let point = Softness {
        light_radius: 0.0,
        ..bulb
    };
    let sky = Softness {
        light: DVec4::new(0.6, 0.8, 0.0, 0.0),
        ..bulb
    };
    for (softness, height_m, expected_m) in [
        (&bulb, 0.5, RADIUS_M),
        (&bulb, 0.8, 4.0 * RADIUS_M),
        // Occluders as high as the light, higher, and so close below it that the disc fills the
        // sky.
        (&bulb, LIGHT_M, LIGHT_M),
        (&bulb, 1.5, 1.5),
        (&bulb, 0.99, 0.99),
        (&point, LIGHT_M, 0.0),
        (&sky, 0.4, 0.5 * RADIUS_M),
    ] {
        let actual_m = softness.penumbra_radius_m(height_m);
        assert!(
            (actual_m - expected_m).abs() < 1e-12,
            "{height_m} m: {actual_m} m"
        );
    }
}
