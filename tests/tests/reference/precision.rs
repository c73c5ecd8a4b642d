//! What 32-bit rounding costs: each reference in both precisions, on a case of another test.
//!
//! A shader that is farther from its reference than these bounds is so by its algorithm.

use glam::DVec3;
use harness::reference::fit::{FitConstants, fit_receiver, fit_toy};

use crate::fit::{layout, lit_toy, samples};
use crate::flat::{start, truth};

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
