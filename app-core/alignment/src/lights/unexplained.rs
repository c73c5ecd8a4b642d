//! The residual of a shading, and the fraction of it that one more lamp would explain.

use nalgebra::{Cholesky, Const};

use super::shading::{FIRST_LAMP, Factors, N_FACTORS, PRIOR, Shaded, Shading, add_outer};

/// The residual of a shading.
pub(super) struct Unexplained<'a> {
    shaded: &'a Shaded<'a>,
    /// Weight and residual of each channel of each pixel.
    pixels: Vec<[(f64, f64); 3]>,
    /// Normal equations of the factors of each receiver and channel.
    normals: Vec<Option<Cholesky<f64, Const<N_FACTORS>>>>,
    loss: f64,
}

impl<'a> Unexplained<'a> {
    pub(super) fn new(shaded: &'a Shaded<'a>, shading: &Shading, robust: f64) -> Self {
        let n_columns = FIRST_LAMP + shaded.lamps.len();
        let mut normals = vec![nalgebra::SMatrix::identity() * PRIOR; 3 * shading.factors.len()];
        let mut pixels = vec![[(0.0, 0.0); 3]; shaded.pixels.len()];
        let mut loss = 0.0;
        for (index, pixel) in shaded.pixels.iter().enumerate() {
            let columns = shaded.columns(index);
            for channel in 0..3 {
                let factors = &shading.factors[pixel.receiver][channel];
                let Some(one) = shaded.residual((index, channel), &columns, factors, robust) else {
                    continue;
                };
                pixels[index][channel] = (one.weight, one.residual);
                loss += one.weight * one.residual * one.residual;
                add_outer(
                    &mut normals[3 * pixel.receiver + channel],
                    &one.row,
                    one.weight,
                    n_columns,
                );
            }
        }
        Self {
            shaded,
            pixels,
            normals: normals.into_iter().map(nalgebra::SMatrix::cholesky).collect(),
            loss,
        }
    }

    /// The fraction of the loss that one more lamp would explain, with all factors fitted anew; the
    /// lamp is given by the light that the toy blocks.
    pub(super) fn explained(&self, taken: &[f32]) -> f64 {
        let mut blocks = vec![(Factors::zeros(), 0.0, 0.0); self.normals.len()];
        for (index, taken) in taken.iter().enumerate().filter(|(_, taken)| **taken > 0.0) {
            let pixel = &self.shaded.pixels[index];
            let columns = self.shaded.columns(index);
            for channel in 0..3 {
                let (weight, residual) = self.pixels[index][channel];
                let plate = f64::from(pixel.plate[channel]);
                let column = -plate * f64::from(*taken);
                let (mixed, square, side) = &mut blocks[3 * pixel.receiver + channel];
                *mixed += columns * (plate * weight * column);
                *square += weight * column * column;
                *side += weight * column * residual;
            }
        }
        let explained = blocks.iter().zip(&self.normals);
        let explained = explained.map(|((mixed, square, side), normal)| {
            let known = normal
                .as_ref()
                .map_or(0.0, |normal| mixed.dot(&normal.solve(mixed)));
            // A lamp cannot be negative.
            side.max(0.0).powi(2) / (square - known + PRIOR)
        });
        explained.sum::<f64>() / self.loss.max(f64::MIN_POSITIVE)
    }
}
