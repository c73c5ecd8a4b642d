//! The light on a matt toy: spherical harmonics for light from all around, and a cosine for each
//! known lamp.

use glam::DVec3;
use nalgebra::{SMatrix, SVector};

use crate::picture::{Color, noise_deviation};
use app_scene::scene::MAX_LIGHTS;

/// Number of spherical harmonics of the first three orders, which describe the irradiance of a matt
/// surface.
///
/// Source: Ramamoorthi and Hanrahan 2001.
const N_HARMONICS: usize = 9;
/// The harmonics are a tenth off where a small lamp grazes a surface: a known one has a term of its
/// own, the cosine (Lambert).
const N_BASIS: usize = N_HARMONICS + MAX_LIGHTS;
/// Weight of the prior on each order beyond the first, over that of the pixels: the visible side of
/// a toy does not constrain all.
const PRIOR: f64 = 1e-3;
/// Rounds of reweighting, and the scale of Cauchy's weights, relative to the light: the error of
/// shading by facets and contact.
const N_ROUNDS: usize = 4;
const ROBUST: f64 = 0.15;
/// Lower bound of a surface's irradiance, over the mean: darker pixels are in shadow, which the
/// model does not have.
const DARKEST: f32 = 0.15;
/// Number of pixels that an estimate needs.
const LEAST_PIXELS: usize = 100;
/// Lower bound of paints, since light is divided by them.
const DARKEST_PAINT: f32 = 0.01;

type Basis = SVector<f64, N_BASIS>;

/// The toy's surface at a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub(super) color: Color,
    pub(super) normal: DVec3,
}

impl Surface {
    /// Its colour in a channel, which light is divided by.
    pub(super) fn paint(&self, channel: usize) -> f32 {
        self.color[channel].max(DARKEST_PAINT)
    }

    fn basis(&self, to_lights: &[DVec3]) -> Basis {
        let DVec3 { x, y, z } = self.normal;
        let harmonics: [f64; N_HARMONICS] = [
            1.0,
            x,
            y,
            z,
            x * y,
            y * z,
            x * z,
            3.0 * z * z - 1.0,
            x * x - y * y,
        ];
        let cosines = to_lights
            .iter()
            .map(|to_light| self.normal.dot(*to_light).max(0.0));
        let none = std::iter::repeat(0.0);
        Basis::from_iterator(harmonics.into_iter().chain(cosines).chain(none).take(N_BASIS))
    }
}

/// The light on the toy: coefficients of each harmonic and of each lamp, for each channel.
#[derive(Clone, Debug)]
pub(super) struct Light {
    to_lights: Vec<DVec3>,
    factors: [Basis; 3],
    least: Color,
}

impl Light {
    /// Fits the light to surfaces and their colours in a photograph, by iteratively reweighted least
    /// squares; `None` if they are too few. `to_lights` are unit vectors towards known lamps.
    pub(super) fn fitted(pixels: &[(Surface, Color)], to_lights: &[DVec3]) -> Option<Self> {
        if pixels.len() < LEAST_PIXELS {
            return None;
        }
        let with_basis = |(surface, shown): &(Surface, Color)| (*surface, surface.basis(to_lights), *shown);
        let pixels: Vec<Shown> = pixels.iter().map(with_basis).collect();
        let factors = [0, 1, 2].map(|channel| fitted(&pixels, channel));
        let mut mean = [0.0_f64; 3];
        for (_, basis, _) in &pixels {
            for channel in 0..3 {
                mean[channel] += basis.dot(&factors[channel]).max(0.0);
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
        let least = mean.map(|sum| DARKEST * (sum / pixels.len() as f64) as f32);
        Some(Self {
            to_lights: to_lights.to_vec(),
            factors,
            least,
        })
    }

    pub(super) fn shade(&self, surface: &Surface) -> Color {
        let basis = surface.basis(&self.to_lights);
        [0, 1, 2].map(|channel| {
            #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
            let light = basis.dot(&self.factors[channel]) as f32;
            surface.paint(channel) * light.max(self.least[channel])
        })
    }
}

/// A pixel of the toy: its surface, the terms of the light there, and its colour in the photograph.
type Shown = (Surface, Basis, Color);

fn fitted(pixels: &[Shown], channel: usize) -> Basis {
    let mut factors: Option<Basis> = None;
    for _ in 0..N_ROUNDS {
        let mut normal = SMatrix::<f64, N_BASIS, N_BASIS>::zeros();
        let mut side = Basis::zeros();
        for (surface, basis, shown) in pixels {
            let paint = f64::from(surface.paint(channel));
            let shown = f64::from(shown[channel]);
            let row = paint * basis;
            // Errors of the model are proportional to the light, those of the picture are noise.
            #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
            let noise = f64::from(noise_deviation(shown as f32));
            let scale = noise.hypot(ROBUST * shown);
            let excess = factors.map_or(0.0, |factors| (shown - row.dot(&factors)) / scale);
            let weight = 1.0 / (scale * scale * (1.0 + excess * excess));
            normal += weight * row * row.transpose();
            side += weight * shown * row;
        }
        let prior = PRIOR * normal[(0, 0)];
        for order in 1..N_BASIS {
            normal[(order, order)] += prior;
        }
        let Some(factor) = normal.cholesky() else { break };
        factors = Some(factor.solve(&side));
    }
    factors.unwrap_or_else(Basis::zeros)
}
