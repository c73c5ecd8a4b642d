//! The light on a toy of a given gloss, and its residual.
//!
//! Source: Holland and Welsch 1977 (iteratively reweighted least squares), Lawson and Hanson 1974,
//! 23 (light is not negative).

use app_scene::gloss::N_GLOSSES;
use nalgebra::SMatrix;

use super::columns::{Columns, N_COLUMNS};
use super::look::{Look, Sample};
use crate::median::median;

/// Residual, over what is expected, at which a pixel counts half: light between parts of the toy is not modelled.
const CAUCHY_SCALE: f64 = 0.12;
/// Smallest expected linear light: below it residuals are noise.
const DARKEST: f64 = 0.02;
/// Rounds of reweighting.
const N_ROUNDS: usize = 6;
/// Weight of the prior for zero light, relative to the mean energy of the unknowns.
const PRIOR: f64 = 1e-4;
/// Largest share of reflected light in a pixel from which paint is estimated.
const LITTLE_REFLECTED: f64 = 0.3;
/// Minimum number of such pixels.
const LEAST_OF_MATERIAL: usize = 20;
/// Range of a material's tint.
const TINTS: [f64; 2] = [0.3, 3.0];

type Tints = [[f64; 3]; N_GLOSSES];

/// A toy with a gloss.
pub(super) struct Glossy<'a> {
    /// The reflection of each sample at strength 1.
    pub(super) reflected: &'a [Columns],
    pub(super) strengths: [f64; N_GLOSSES],
}

/// Mean loss after fitting the light on the toy, with paints that may differ from the model's.
pub(super) fn loss(look: &Look, glossy: &Glossy<'_>) -> f64 {
    let mut weights = vec![[1.0; 3]; look.len()];
    let mut tints: Tints = [[1.0; 3]; N_GLOSSES];
    let mut mean = 0.0;
    for round in 0..N_ROUNDS {
        let light = [0, 1, 2].map(|channel| fitted(look, glossy, (&weights, &tints), channel));
        let parts: Vec<[Part; 3]> = (look.samples.iter().zip(glossy.reflected))
            .map(|(sample, reflected)| {
                let strength = glossy.strengths[sample.material];
                [0, 1, 2].map(|channel| Part {
                    paint: sample.base[channel] * sample.received.dot(&light[channel]),
                    reflected: strength * reflected.dot(&light[channel]),
                })
            })
            .collect();
        if round > 0 {
            tint(look, &parts, &mut tints);
        }
        mean = reweigh(look, &parts, &tints, &mut weights);
    }
    mean
}

/// The expected parts of a pixel's light, in one channel.
#[derive(Clone, Copy)]
struct Part {
    paint: f64,
    reflected: f64,
}

/// The fitted light of a channel.
fn fitted(
    look: &Look,
    glossy: &Glossy<'_>,
    (weights, tints): (&[[f64; 3]], &Tints),
    channel: usize,
) -> Columns {
    let mut normal = SMatrix::<f64, N_COLUMNS, N_COLUMNS>::zeros();
    let mut side = Columns::zeros();
    for ((sample, reflected), weight) in look.samples.iter().zip(glossy.reflected).zip(weights) {
        if !sample.is_usable[channel] {
            continue;
        }
        let paint = tints[sample.material][channel] * sample.base[channel];
        let row = paint * sample.received + glossy.strengths[sample.material] * reflected;
        let weighted = weight[channel] * row;
        normal += weighted * row.transpose();
        side += sample.shown[channel] * weighted;
    }
    let prior = PRIOR * normal.trace() / look.n_columns as f64;
    for index in 0..N_COLUMNS {
        // Unused columns stay at 0.
        normal[(index, index)] += prior.max(f64::MIN_POSITIVE);
    }
    non_negative(&normal, &side)
}

/// Removes unknowns that would be negative, the most negative one first.
fn non_negative(normal: &SMatrix<f64, N_COLUMNS, N_COLUMNS>, side: &Columns) -> Columns {
    let (mut normal, mut side) = (*normal, *side);
    for _ in 0..N_COLUMNS {
        let Some(factor) = normal.cholesky() else { break };
        let found = factor.solve(&side);
        let lowest = found.imin();
        if found[lowest] >= 0.0 {
            return found;
        }
        normal.row_mut(lowest).fill(0.0);
        normal.column_mut(lowest).fill(0.0);
        normal[(lowest, lowest)] = 1.0;
        side[lowest] = 0.0;
    }
    Columns::zeros()
}

/// Each material's paint in the photograph, relative to the model's. Their mean brightness is the
/// same.
fn tint(look: &Look, parts: &[[Part; 3]], tints: &mut Tints) {
    for channel in 0..3 {
        let told = |(sample, part): (&Sample, &[Part; 3])| {
            let part = part[channel];
            let is_known = sample.is_usable[channel]
                && part.paint > 0.0
                && part.reflected < LITTLE_REFLECTED * part.paint;
            is_known.then(|| (sample.shown[channel] - part.reflected) / part.paint)
        };
        for (material, tint) in tints.iter_mut().take(look.n_materials).enumerate() {
            let all = look.samples.iter().zip(parts);
            let own = all.filter(|(sample, _)| sample.material == material);
            let ratios: Vec<f64> = own.filter_map(told).collect();
            if ratios.len() >= LEAST_OF_MATERIAL {
                let middle = median(ratios, f64::total_cmp).unwrap_or(1.0);
                tint[channel] = middle.clamp(TINTS[0], TINTS[1]);
            }
        }
        let (mut energy, mut tinted) = (0.0, 0.0);
        for (sample, part) in look.samples.iter().zip(parts) {
            let squared = part[channel].paint * part[channel].paint;
            energy += squared;
            tinted += tints[sample.material][channel] * squared;
        }
        if tinted > 0.0 {
            tints.iter_mut().for_each(|tint| tint[channel] *= energy / tinted);
        }
    }
}

/// Weights each pixel by its residual. Returns the mean loss.
fn reweigh(look: &Look, parts: &[[Part; 3]], tints: &Tints, weights: &mut [[f64; 3]]) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for ((sample, part), weight) in look.samples.iter().zip(parts).zip(weights) {
        for channel in 0..3 {
            if !sample.is_usable[channel] {
                continue;
            }
            let Part { paint, reflected } = part[channel];
            let expected = tints[sample.material][channel] * paint + reflected;
            let scale = CAUCHY_SCALE * expected.max(DARKEST);
            let squared = ((sample.shown[channel] - expected) / scale).powi(2);
            weight[channel] = 1.0 / ((1.0 + squared) * scale * scale);
            sum += squared.ln_1p();
            n += 1.0;
        }
    }
    if n > 0.0 { sum / n } else { 0.0 }
}
