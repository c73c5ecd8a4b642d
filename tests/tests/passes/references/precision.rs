//! The error of 32-bit rounding: rays in both precisions, in a case of another test.
//!
//! A shader whose difference from its reference exceeds these bounds differs in its algorithm.

use glam::{DMat4, DVec2, DVec3, DVec4, UVec2};
use reference::occlusion::Caster;
use reference::raster::Raster;
use reference::real::Real;
use reference::visibility::{exact_visibility, visibility_map};

use crate::references::flat::region;
use crate::references::visibility::{bulb, square};

/// A texel counts 256 light points: the result differs only for a ray within rounding of the edge.
fn shadow<R: Real>() -> Raster<f64> {
    let light_points = bulb().points_in(&DMat4::IDENTITY, DVec3::ZERO, 256);
    let light_points: Vec<DVec4> = light_points.iter().map(|point| point.as_dvec4()).collect();
    let region = region(UVec2::splat(80), light_points[..1].to_vec());
    let caster = Caster {
        occluder: square::<R>(),
        light_points,
    };
    visibility_map(&[caster], &region, region.size_px)
}

#[test]
fn shadow_of_a_square() {
    let (narrow, wide) = (shadow::<f32>(), shadow::<f64>());
    let pairs = narrow.texels().iter().zip(wide.texels());
    let n_others = pairs.filter(|(a, b)| a != b).count();
    // Measured: none of 6400. The next test proves that rays are computed in 32 bits at all.
    assert!(n_others <= 5, "{n_others} texels");
}

#[test]
fn ray_to_a_square() {
    let (origin, direction) = (DVec3::new(0.1, 1.0, 0.0), DVec3::new(0.1, -0.9, 0.3));
    let narrow = square::<f32>().nearest(origin, direction).unwrap();
    let wide = square::<f64>().nearest(origin, direction).unwrap();
    assert_eq!(narrow.triangle, wide.triangle);
    let cost = (narrow.distance - wide.distance).abs();
    // Measured: 2.0e-8.
    assert!(cost > 0.0 && cost < 1e-7, "{cost:e}");
}

#[test]
fn penumbra_of_a_square() {
    // From the umbra to the light.
    let cost = |step: u32| {
        let at = DVec2::new(0.2 + 0.002 * f64::from(step), 0.0137);
        let narrow = exact_visibility(&square::<f32>(), at, &bulb(), 1024);
        (narrow - exact_visibility(&square::<f64>(), at, &bulb(), 1024)).abs()
    };
    let cost = (0..200).map(cost).fold(0.0, f64::max);
    // Measured: 6.1e-7. One ray more or less would be 1e-3.
    assert!(cost > 0.0 && cost < 2e-6, "{cost:e}");
}
