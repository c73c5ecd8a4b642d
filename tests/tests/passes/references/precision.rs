//! What 32-bit rounding costs: each reference in both precisions, on a case of another test.
//!
//! A shader that is farther from its reference than these bounds is so by its algorithm.

use glam::{DMat4, DVec2, DVec3, DVec4, UVec2};
use reference::composite::receiver_color;
use reference::fit::{FitConstants, fit_receiver, fit_toy};

use reference::occlusion::Caster;
use reference::raster::Raster;
use reference::real::Real;
use reference::self_shadow::received;
use reference::visibility::{exact_visibility, visibility_map};

use crate::references::composite::{SIZE, scene};
use crate::references::fit::{layout, lit_toy, samples};
use crate::references::flat::{region, start, truth, two_bulbs};
use crate::references::visibility::{bulb, square};

/// The largest difference of two lists of colours, which must not be the same to the last bit: else one precision was used
/// for both.
fn cost(narrow: &[DVec3], wide: &[DVec3]) -> f64 {
    assert_eq!(narrow.len(), wide.len());
    let pairs = narrow.iter().zip(wide);
    let cost = pairs
        .map(|(a, b)| (a - b).abs().max_element())
        .fold(0.0, f64::max);
    assert!(cost > 0.0, "both are of one precision");
    cost
}

#[test]
fn fit_of_a_receiver() {
    let constants = FitConstants::default();
    for n_lights in [1, 2] {
        let region = layout(n_lights);
        let samples = samples(&region, &truth(n_lights));
        let narrow = fit_receiver::<f32>(&region, (0, &samples), &start(n_lights), &constants, 5);
        let wide = fit_receiver::<f64>(&region, (0, &samples), &start(n_lights), &constants, 5);
        let (of_narrow, of_wide) = (&narrow.receivers[0], &wide.receivers[0]);
        let fractions = cost(&of_narrow.direct_fractions, &of_wide.direct_fractions);
        let gain = cost(&[narrow.gain], &[wide.gain]);
        let bounce = cost(&[of_narrow.bounce], &[of_wide.bounce]);
        // Measured: 2.4e-6, 3.9e-6 and 1.7e-5, with one light and with two.
        assert!(fractions < 1e-5, "{n_lights} lights: {fractions:e}");
        assert!(gain < 1e-5, "{n_lights} lights: {gain:e}");
        assert!(bounce < 5e-5, "{n_lights} lights: {bounce:e}");
    }
}

#[test]
fn fit_of_the_toy() {
    let (_, known, samples) = lit_toy();
    let constants = FitConstants::default();
    let narrow = fit_toy::<f32>(&layout(2), &samples, &known, &constants, 5);
    let wide = fit_toy::<f64>(&layout(2), &samples, &known, &constants, 5);
    let cost = cost(&narrow.toy, &wide.toy);
    // Measured: 8.8e-6.
    assert!(cost < 3e-5, "{cost:e}");
}

/// A texel counts 256 light points: only a ray within rounding of the edge counts otherwise.
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
    // Measured: none of 6400. That a ray is computed in 32 bits at all, the next test tells.
    assert!(n_others <= 5, "{n_others} texels");
}

#[test]
fn ray_to_a_square() {
    let (origin, direction) = (DVec3::new(0.1, 1.0, 0.0), DVec3::new(0.1, -0.9, 0.3));
    let narrow = square::<f32>().nearest(origin, direction).unwrap();
    let wide = square::<f64>().nearest(origin, direction).unwrap();
    assert_eq!(narrow.triangle, wide.triangle);
    let cost = cost(&[DVec3::splat(narrow.distance)], &[DVec3::splat(wide.distance)]);
    // Measured: 2.0e-8.
    assert!(cost < 1e-7, "{cost:e}");
}

#[test]
fn penumbra_of_a_square() {
    // From the umbra to the light.
    let at = |step: u32| DVec2::new(0.2 + 0.002 * f64::from(step), 0.0137);
    let visibility = |step: u32| {
        let narrow = exact_visibility(&square::<f32>(), at(step), &bulb(), 1024);
        let wide = exact_visibility(&square::<f64>(), at(step), &bulb(), 1024);
        (DVec3::splat(narrow), DVec3::splat(wide))
    };
    let (narrow, wide): (Vec<DVec3>, Vec<DVec3>) = (0..200).map(visibility).unzip();
    let cost = cost(&narrow, &wide);
    // Measured: 6.1e-7. One ray more or less would be 1e-3.
    assert!(cost < 2e-6, "{cost:e}");
}

#[test]
fn picture_after_a_move() {
    fn colors<R: Real>() -> Vec<DVec3> {
        let (region, pictures, mut shown) = scene();
        // More light than before, by all amounts: each part of the picture is at work.
        shown.visibility = shown.visibility.map(|visibility| 0.5 * (visibility + 1.0));
        let of = |texel| receiver_color::<R>(&region, &pictures, &shown, texel);
        Raster::from_fn(SIZE, of).texels().as_flattened().to_vec()
    }
    let cost = cost(&colors::<f32>(), &colors::<f64>());
    // Measured: 2.1e-6.
    assert!(cost < 1e-5, "{cost:e}");
}

#[test]
fn light_under_a_square() {
    fn colors<R: Real>() -> Vec<DVec3> {
        let lights = two_bulbs();
        let region = region(UVec2::splat(80), lights.clone());
        // A row of points for each bulb.
        let points = |bulb: DVec4| (0..16).map(|i| bulb + 0.01 * f64::from(i) * DVec4::Z).collect();
        let points: Vec<Vec<DVec4>> = lights.into_iter().map(points).collect();
        let normal = DVec3::new(0.1, 1.0, -0.2).normalize();
        let at = |step: u32| DVec3::new(0.003 * f64::from(step), 0.002, 0.1);
        let of = |step| received(&region, &square::<R>(), &points, at(step), normal).truncate();
        (0..200).map(of).collect()
    }
    let cost = cost(&colors::<f32>(), &colors::<f64>());
    // Measured: 1.2e-7. One point more or less in sight would be 1e-2.
    assert!(cost < 5e-7, "{cost:e}");
}
