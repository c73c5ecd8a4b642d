//! Which lights' strengths the sums of a fit tell.

use app_core::gpu::layout::{N_COLUMNS, N_FIT_SUMS};
use app_core::resolution::light_resolution;

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
    let together = light_resolution(&sums_of(&[lit, near_contact, in_both]), 2);
    assert!(
        together.iter().all(|told| (told - 0.5).abs() < 0.01),
        "{together:?}"
    );
    let apart = light_resolution(&sums_of(&[lit, near_contact, in_first, in_both]), 2);
    assert!(apart.iter().all(|told| *told > 0.99), "{apart:?}");
    assert_eq!(light_resolution(&sums_of(&[]), 2), [0.0, 0.0]);
}
