//! The light on the receivers for given shadows: linear in the intensities of each lamp and of the
//! ambient light.
//!
//! Frame over plate = gain - sum of ambient factors x (1 - A) - sum over lamps of factor x light
//! blocked of it, for each receiver and channel: the additive model of `fit`, without the toy's
//! bounce, which the ambient factors absorb. They are linear over the plane.
//!
//! With several receivers, the gain is a polynomial over each: a wall reflects less light onto a
//! table, since the shadow lies on it too, and the table darkens over a wide area, which a constant
//! gain would leave to a penumbra that is too wide. Without a plate it absorbs errors of the
//! background model. On one receiver with a plate it is constant, or it would absorb the evidence
//! for the scale of the world.

use nalgebra::{SMatrix, SVector};

use super::background::QUADRATIC;
use super::cast::{Ambient, N_AMBIENT};
use super::receiver_pixels::ReceiverPixel;
use app_scene::scene::MAX_LIGHTS;

/// Number of factors: those of the gain, ambient factors, and one factor per lamp.
pub(super) const N_FACTORS: usize = FIRST_LAMP + MAX_LIGHTS;
/// Index of the first lamp's factor.
pub(super) const FIRST_LAMP: usize = QUADRATIC + N_AMBIENT;

pub(super) type Factors = SVector<f64, N_FACTORS>;
pub(super) type Normal = SMatrix<f64, N_FACTORS, N_FACTORS>;

/// Keeps unconstrained factors at 0.
pub(super) const PRIOR: f64 = 1e-3;
/// Rounds of reweighting.
const N_ROUNDS: usize = 3;

/// The pixels of a shading, with the light that the toy blocks there.
pub(super) struct Shaded<'a> {
    pub(super) pixels: &'a [ReceiverPixel],
    pub(super) ambient: &'a [Ambient],
    pub(super) lamps: &'a [Vec<f32>],
}

/// Factors of each receiver and channel.
#[derive(Debug)]
pub(super) struct Shading {
    pub(super) factors: Vec<[Factors; 3]>,
    /// Mean robust loss of a channel of a pixel, in variances; of the factors before the last
    /// round.
    pub(super) loss: f64,
}

impl Shading {
    /// A lamp's share of the light on a receiver below the toy, in the mean over the channels.
    pub(super) fn share(&self, receiver: usize, lamp: usize) -> f64 {
        let of_channels = self.factors[receiver].iter();
        let shares = of_channels.map(|factors| factors[FIRST_LAMP + lamp] / factors[0].max(PRIOR));
        shares.sum::<f64>() / 3.0
    }

    /// A lamp's light, over all receivers and channels.
    fn light_of(&self, lamp: usize) -> f64 {
        let factors = self.factors.iter().flatten();
        factors.map(|factors| factors[FIRST_LAMP + lamp]).sum()
    }
}

/// One channel of one pixel compared with a shading.
pub(super) struct Residual {
    /// Frame minus model, in linear light.
    pub(super) residual: f64,
    /// Robust weight: one over a variance, or less.
    pub(super) weight: f64,
    /// Derivatives by the factors.
    pub(super) row: Factors,
    loss: f64,
}

impl Shaded<'_> {
    /// The columns of one pixel: the gain's terms, then minus the blocked light.
    pub(super) fn columns(&self, index: usize) -> Factors {
        let mut columns = Factors::zeros();
        for (term, value) in self.pixels[index].gain.iter().enumerate() {
            columns[term] = f64::from(*value);
        }
        for (part, taken) in self.ambient[index].iter().enumerate() {
            columns[QUADRATIC + part] = -f64::from(*taken);
        }
        for (lamp, taken) in self.lamps.iter().enumerate() {
            columns[FIRST_LAMP + lamp] = -f64::from(taken[index]);
        }
        columns
    }

    /// One channel of a pixel; `None` if it is unreliable. `robust` is the scale of the weights, in
    /// standard deviations.
    pub(super) fn residual(
        &self,
        (index, channel): (usize, usize),
        columns: &Factors,
        factors: &Factors,
        robust: f64,
    ) -> Option<Residual> {
        let pixel = &self.pixels[index];
        let precision = f64::from(pixel.precision[channel]);
        if precision <= 0.0 {
            return None;
        }
        let row = columns * f64::from(pixel.plate[channel]);
        let residual = f64::from(pixel.frame[channel]) - row.dot(factors);
        let (square, scale_square) = (residual * residual * precision, robust * robust);
        Some(Residual {
            residual,
            weight: precision * crate::robust::weight(square / scale_square),
            row,
            loss: crate::robust::loss(square, scale_square),
        })
    }

    /// Fits all factors by iteratively reweighted least squares, starting from the plate.
    pub(super) fn fit(&self, n_receivers: usize, robust: f64) -> Shading {
        let mut lit = Factors::zeros();
        lit[0] = 1.0;
        let mut shading = Shading {
            factors: vec![[lit; 3]; n_receivers],
            loss: f64::INFINITY,
        };
        for round in 0..N_ROUNDS {
            // In the first round, all pixels have full weight.
            let scale = if round == 0 { f64::INFINITY } else { robust };
            shading = self.refit(&shading, scale);
        }
        shading
    }

    /// Whether a shading has positive light of each lamp whose shadow is visible.
    pub(super) fn has_light_of_all(&self, shading: &Shading) -> bool {
        let is_visible = |taken: &[f32]| {
            let mut both = taken.iter().zip(self.pixels);
            both.any(|(taken, pixel)| *taken > 0.0 && pixel.has_evidence())
        };
        let mut lamps = self.lamps.iter().enumerate();
        lamps.all(|(lamp, taken)| shading.light_of(lamp) > 0.0 || !is_visible(taken))
    }

    /// Mean robust loss of a shading, for a channel of the pixels with a property; 0 without any.
    pub(super) fn loss(&self, shading: &Shading, robust: f64, is_counted: impl Fn(usize) -> bool) -> f64 {
        let (mut loss, mut n) = (0.0, 0.0);
        for index in (0..self.pixels.len()).filter(|index| is_counted(*index)) {
            let columns = self.columns(index);
            let factors = &shading.factors[self.pixels[index].receiver];
            for (channel, factors) in factors.iter().enumerate() {
                if let Some(one) = self.residual((index, channel), &columns, factors, robust) {
                    loss += one.loss;
                    n += 1.0;
                }
            }
        }
        if n > 0.0 { loss / n } else { 0.0 }
    }

    fn refit(&self, from: &Shading, robust: f64) -> Shading {
        let mut normals = vec![[Normal::identity() * PRIOR; 3]; from.factors.len()];
        let mut sides = vec![[Factors::zeros(); 3]; from.factors.len()];
        let (mut loss, mut n) = (0.0, 0.0);
        for (index, pixel) in self.pixels.iter().enumerate() {
            let columns = self.columns(index);
            for channel in 0..3 {
                let factors = &from.factors[pixel.receiver][channel];
                let Some(one) = self.residual((index, channel), &columns, factors, robust) else {
                    continue;
                };
                loss += one.loss;
                n += 1.0;
                let normal = &mut normals[pixel.receiver][channel];
                add_outer(normal, &one.row, one.weight, FIRST_LAMP + self.lamps.len());
                let seen = f64::from(pixel.frame[channel]);
                sides[pixel.receiver][channel] += one.row * (one.weight * seen);
            }
        }
        let solved = normals.iter().zip(&sides).zip(&from.factors);
        let solved = solved.map(|((normals, sides), before)| {
            [0, 1, 2].map(|channel| {
                let factor = normals[channel].cholesky();
                factor.map_or(before[channel], |factor| factor.solve(&sides[channel]))
            })
        });
        Shading {
            factors: solved.collect(),
            loss: if n > 0.0 { loss / n } else { 0.0 },
        }
    }
}

/// Adds `weight` times the outer product of the first `n` entries to the lower triangle, which is
/// all that Cholesky's method reads.
pub(super) fn add_outer(normal: &mut Normal, row: &Factors, weight: f64, n: usize) {
    for j in 0..n {
        let scaled = weight * row[j];
        // A constant gain has terms that are 0 everywhere.
        if scaled != 0.0 {
            for i in j..n {
                normal[(i, j)] += scaled * row[i];
            }
        }
    }
}
