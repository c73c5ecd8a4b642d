//! Conditioning of each light's direct fraction: the share that the real shadow, rather than the
//! prior, determines.
//!
//! The fit of a receiver solves (A + w I) x = b + w prior, where A are the sums of the normal
//! equations; on receivers after the first, the gain of the first one counts as a sum of its own. The
//! diagonal of its resolution matrix, 1 - w (A + w I)^-1, is 1 for an unknown that the sums alone
//! determine and 0 for one that the prior determines: for two lights whose shadows always coincide,
//! only the sum is constrained.
//!
//! Source: Backus and Gilbert 1968 (resolution of an inverse problem).

use crate::model::state::solution::{N_CHANNELS, N_COLUMNS, N_FIT_SUMS, PRIOR_WEIGHT, SAME_GAIN_WEIGHT};
use app_scene::scene::MAX_RECEIVERS;

type Matrix = [[f64; N_COLUMNS]; N_COLUMNS];

/// Resolution of each light, from 0 to 1: the largest of the receivers' means over channels. `sums` are the
/// accumulated sums of the fits.
#[must_use]
pub fn light_conditioning(sums: &[f32], n_lights: usize) -> Vec<f64> {
    let mut most = vec![0.0_f64; n_lights];
    let receivers = sums.chunks_exact(N_CHANNELS * N_FIT_SUMS).take(MAX_RECEIVERS);
    for (receiver, sums) in receivers.enumerate() {
        let gain_weight = if receiver > 0 { SAME_GAIN_WEIGHT } else { 0.0 };
        let channels = sums.chunks_exact(N_FIT_SUMS);
        let resolved: Vec<_> = channels
            .map(|sums| channel_resolution(sums, 2 + n_lights, gain_weight.into()))
            .collect();
        for (light, most) in most.iter_mut().enumerate() {
            let sum: f64 = resolved.iter().map(|columns| columns[2 + light]).sum();
            *most = most.max(sum / N_CHANNELS as f64);
        }
    }
    most
}

/// Resolution of each column; 0 without any pixel. The gain is known with a weight, relative to the energy
/// of its column.
fn channel_resolution(sums: &[f32], n_columns: usize, gain_weight: f64) -> [f64; N_COLUMNS] {
    let energy = f64::from(sums[0]);
    if energy <= 0.0 {
        return [0.0; N_COLUMNS];
    }
    let weight = f64::from(PRIOR_WEIGHT) * energy;
    let mut matrix: Matrix = [[0.0; N_COLUMNS]; N_COLUMNS];
    let upper = (0..N_COLUMNS).flat_map(|i| (i..N_COLUMNS).map(move |j| (i, j)));
    for ((i, j), sum) in upper.zip(sums) {
        matrix[i][j] = f64::from(*sum);
        matrix[j][i] = f64::from(*sum);
    }
    (0..N_COLUMNS).for_each(|i| matrix[i][i] += weight);
    matrix[0][0] += gain_weight * energy;
    inverse_diagonal(matrix, n_columns).map(|inverse| (1.0 - weight * inverse).max(0.0))
}

/// Diagonal of the inverse of the first `n` rows and columns; the matrix is symmetric and positive
/// definite.
///
/// Column k of the inverse solves M x = e_k, so x_k is 1 over the pivot of k when k is eliminated
/// last.
fn inverse_diagonal(matrix: Matrix, n: usize) -> [f64; N_COLUMNS] {
    let mut diagonal = [0.0; N_COLUMNS];
    for (last, inverse) in diagonal.iter_mut().enumerate().take(n) {
        let mut left = matrix;
        for pivot in (0..n).filter(|pivot| *pivot != last) {
            for row in (0..n).filter(|row| *row > pivot || *row == last) {
                let factor = left[row][pivot] / left[pivot][pivot];
                let above = left[pivot];
                left[row]
                    .iter_mut()
                    .zip(above)
                    .for_each(|(value, above)| *value -= factor * above);
            }
        }
        *inverse = 1.0 / left[last][last];
    }
    diagonal
}
