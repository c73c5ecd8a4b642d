//! Joint solution for the gains of many plates from gains of pairs: the error of closure of a loop
//! is distributed over its pairs.

use glam::DVec3;

use app_scene::disjoint::DisjointSets;

/// The gain between two plates.
pub(crate) struct PairGain {
    /// Indices of the plates; the gain is that of the first to the second.
    pub(crate) plates: [usize; 2],
    /// Per channel, positive.
    pub(crate) gain: DVec3,
    /// Weight among the pairs.
    pub(crate) n_samples: f64,
}

/// Gain of each plate to the first plate to which it is connected, by least squares of logarithms.
///
/// With x the logarithms, every pair has the equation x_a - x_b = ln gain_ab with the weight of its
/// samples. The normal equations are the Laplacian of the graph of pairs, which leaves one constant
/// free for each connected part: the first plate of a part has x = 0, by a weight of 1 on it, which
/// no other equation opposes.
pub(crate) fn joint_gains(n_plates: usize, pairs: &[PairGain]) -> Vec<DVec3> {
    let mut matrix = vec![0.0; n_plates * n_plates];
    let mut unknowns = vec![DVec3::ZERO; n_plates];
    for PairGain {
        plates: [a, b],
        gain,
        n_samples,
    } in pairs
    {
        matrix[a * n_plates + a] += n_samples;
        matrix[b * n_plates + b] += n_samples;
        matrix[a * n_plates + b] -= n_samples;
        matrix[b * n_plates + a] -= n_samples;
        let asked = *n_samples * gain.map(f64::ln);
        unknowns[*a] += asked;
        unknowns[*b] -= asked;
    }
    let firsts = firsts(n_plates, pairs);
    for (plate, first) in firsts.iter().enumerate() {
        if plate == *first {
            matrix[plate * n_plates + plate] += 1.0;
        }
    }
    solve(&mut matrix, &mut unknowns);
    let gains = unknowns.iter().zip(&firsts).enumerate();
    gains
        .map(|(plate, (x, first))| {
            if plate == *first {
                DVec3::ONE
            } else {
                x.map(f64::exp)
            }
        })
        .collect()
}

/// The first of the plates to which each is connected, possibly itself.
fn firsts(n_plates: usize, pairs: &[PairGain]) -> Vec<usize> {
    let mut connected = DisjointSets::new(n_plates);
    for PairGain { plates: [a, b], .. } in pairs {
        connected.join(*a, *b);
    }
    (0..n_plates).map(|plate| connected.first(plate)).collect()
}

/// Gaussian elimination without pivoting: the matrix is symmetric and positive definite.
fn solve(matrix: &mut [f64], unknowns: &mut [DVec3]) {
    let n = unknowns.len();
    for pivot in 0..n {
        let (above, below) = matrix.split_at_mut((pivot + 1) * n);
        let row = &above[pivot * n..];
        for (k, other) in below.chunks_exact_mut(n).enumerate() {
            let factor = other[pivot] / row[pivot];
            if factor == 0.0 {
                continue;
            }
            for (value, above) in other[pivot..].iter_mut().zip(&row[pivot..]) {
                *value -= factor * above;
            }
            let above = unknowns[pivot];
            unknowns[pivot + 1 + k] -= factor * above;
        }
    }
    for row in (0..n).rev() {
        let known: DVec3 = (row + 1..n)
            .map(|column| matrix[row * n + column] * unknowns[column])
            .sum();
        unknowns[row] = (unknowns[row] - known) / matrix[row * n + row];
    }
}
