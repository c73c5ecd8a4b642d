//! The lights whose strengths the sums of a fit constrain.

use app_pipeline::model::diagnostics::conditioning::light_conditioning;
use app_pipeline::model::state::solution::{N_COLUMNS, N_FIT_SUMS};

const N_CHANNELS: usize = 3;

/// Sums of one receiver from rows of columns, the same in each channel.
fn sums_of(rows: &[[f64; N_COLUMNS]]) -> Vec<f32> {
    let upper = (0..N_COLUMNS).flat_map(|i| (i..N_COLUMNS).map(move |j| (i, j)));
    #[allow(clippy::cast_possible_truncation, reason = "as the device has them")]
    let sum = |(i, j): (usize, usize)| rows.iter().map(|row| row[i] * row[j]).sum::<f64>() as f32;
    let mut channel: Vec<f32> = upper.map(sum).collect();
    channel.resize(N_FIT_SUMS, 0.0);
    channel.repeat(N_CHANNELS)
}

#[test]
fn lights_whose_shadows_fall_together_are_told_by_half() {
    let lit = [1.0, 0.0, 0.1, 0.1, 0.0, 0.0];
    let near_contact = [0.5, 0.5, 0.3, 0.3, 0.0, 0.0];
    let in_both = [0.4, 0.6, -0.4, -0.4, 0.0, 0.0];
    let in_first = [0.9, 0.1, -0.5, 0.1, 0.0, 0.0];
    let together = light_conditioning(&sums_of(&[lit, near_contact, in_both]), 2);
    assert!(
        together.iter().all(|told| (told - 0.5).abs() < 0.01),
        "{together:?}"
    );
    let apart = light_conditioning(&sums_of(&[lit, near_contact, in_first, in_both]), 2);
    assert!(apart.iter().all(|told| *told > 0.99), "{apart:?}");
    assert_eq!(light_conditioning(&sums_of(&[]), 2), [0.0, 0.0]);
}

/// A shadow that covers all that is seen of a receiver looks like another gain, and the gain of
/// receivers after the first is known from that one.
#[test]
fn a_shadow_that_covers_a_further_receiver_is_told() {
    let covered = sums_of(&[[0.6, 0.2, -0.3, 0.0, 0.0, 0.0], [0.8, 0.1, -0.4, 0.0, 0.0, 0.0]]);
    let first = light_conditioning(&covered, 1);
    assert!(first[0] < 0.9, "{first:?}");
    let nothing_seen = vec![0.0; covered.len()];
    let further = light_conditioning(&[nothing_seen, covered].concat(), 1);
    assert!(further[0] > 0.9, "{further:?}");
}

#[test]
fn each_light_is_told_by_the_receiver_that_shows_most_of_it() {
    // Each row constrains one unknown alone, so that the sums are diagonal: the resolution is a /
    // (a + w).
    let row = |column: usize, value: f64| {
        let mut row = [0.0; N_COLUMNS];
        row[column] = value;
        row
    };
    let receiver = |values: [f64; 4]| {
        let lights = values
            .iter()
            .enumerate()
            .map(|(light, value)| row(2 + light, *value));
        sums_of(&std::iter::once(row(0, 1.0)).chain(lights).collect::<Vec<_>>())
    };
    let (first, mut second) = (
        receiver([0.02, 0.01, 0.0, 0.0]),
        receiver([0.01, 0.03, 0.0, 0.01]),
    );
    // Its blue channel is empty.
    second[2 * N_FIT_SUMS..].fill(0.0);
    let told = light_conditioning(&[first, second].concat(), 4);
    let one = |value: f64| value * value / (value * value + 1e-4);
    let expected = [
        one(0.02),
        (2.0 / 3.0 * one(0.03)).max(one(0.01)),
        0.0,
        2.0 / 3.0 * one(0.01),
    ];
    for (told, expected) in told.iter().zip(expected) {
        assert!((told - expected).abs() < 1e-6, "{told} is not {expected}");
    }
}

#[test]
fn of_four_lights_only_those_that_fall_together_are_not_told() {
    let lit = [1.0, 0.0, 0.1, 0.1, 0.1, 0.1];
    let in_one = |light: usize| {
        let mut row = [0.9, 0.1, 0.1, 0.1, 0.1, 0.1];
        row[2 + light] = -0.5;
        row
    };
    let in_both = [0.7, 0.3, -0.5, 0.1, 0.1, -0.5];
    let near_contact = [0.5, 0.5, 0.3, 0.3, 0.3, 0.3];
    let told = light_conditioning(&sums_of(&[lit, near_contact, in_both, in_one(1), in_one(2)]), 4);
    assert!(told[1] > 0.99 && told[2] > 0.99, "{told:?}");
    assert!(
        (told[0] - 0.5).abs() < 0.01 && (told[3] - 0.5).abs() < 0.01,
        "{told:?}"
    );
}
