//! One wide light, assumed if a picture shows no lamp: a window to one side, or the bright half of
//! a room.
//!
//! A coarse grid of directions and sizes is tried. The intensity of each, beside the ambient light,
//! is fitted like in the pipeline, with non-negative factors, and compared with the fit of ambient
//! light alone, of fitted strength as well: both are fits of the final picture.

use std::f64::consts::TAU;

use glam::DVec3;
use nalgebra::{Matrix3, Vector3};

use super::hemisphere::climb;
use super::lamp::{Lamp, disc};
use super::receiver_pixels::ReceiverPixel;
use super::shadows::{LEAST_PIXELS, ROBUST_FAR, Shadows};
use crate::picture::Pyramid;
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::robust;
use crate::shape::Shape;

/// Directions to try: this many around, at these elevations above the receiver, in radians (25, 45
/// and 70 degrees). A direction of so wide a light is not constrained any better.
const N_AROUND: usize = 12;
const ELEVATIONS_RAD: [f64; 3] = [0.436, 0.785, 1.222];
/// Tangents of the angular radii to try: of 20 and 35 degrees. `search` finds narrower lights as
/// lamps, and wider ones hardly differ from ambient light.
const SPREADS: [f64; 2] = [0.36, 0.7];
/// Number of points over such a light.
const N_POINTS: usize = 24;
/// The fraction of ambient light's residual that it must explain, in squares.
///
/// Measured: .43 in an office, .45 and .68 under overcast skies, which are brighter above. With it
/// the pictures improved by a twentieth to an eighth, the low-passed error under the skies by a
/// fifth to a third.
const LEAST_EXPLAINED: f64 = 0.3;
/// Its smallest share of the light at the toy's foot: less is within the noise of a plate. Measured
/// .14, .15 and .79 there.
const LEAST_SHARE: f64 = 0.1;
/// Largest share of a light, since part of it is always ambient. The same as in `fit`.
const MOST_SHARE: f64 = 0.98;
/// Rounds of reweighting.
const N_ROUNDS: usize = 3;
/// Keeps an unconstrained unknown at 0.
const PRIOR: f64 = 1e-6;
/// Side of the cells that vertices are merged in, in pixels: a hundred lights of two dozen points
/// are tried.
const CELL_PX: f64 = 0.5;

/// A wide light that explains a picture better than ambient light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wide {
    pub(super) lamp: Lamp,
    /// Share of the light on the receiver nearest to the toy, at the toy's foot.
    pub(super) share: f64,
    /// The fraction of ambient light's residual that it explains.
    pub(super) explained: f64,
}

/// Assumes a wide light; `None` if no such light explains enough, too little of the receivers is
/// visible, or no plate shows them without the toy.
pub(super) fn assume(shape: &Shape, receivers: &[SeenReceiver], pyramid: &Pyramid) -> Option<Wide> {
    let level = pyramid.level(pyramid.smallest_for_shadows());
    level.plate.as_ref()?;
    let mut raster = Rasterizer::default();
    let coarse = shape.merged_in_px(CELL_PX, level);
    let shadows = Shadows::new(&mut raster, (&coarse, receivers), level, None);
    if shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let evidence = Evidence::of(&shadows);
    let disc = disc(N_POINTS);
    let mut fit = |lamp: &Lamp| evidence.with(&shadows.taken(&mut raster, lamp, &disc));
    let best = lamps(receivers)
        .map(|lamp| (fit(&lamp).left, lamp))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (_, lamp) = climb(&best.1, |lamp| -fit(lamp).left);
    let WithLamp { left, share } = fit(&lamp);
    let explained = 1.0 - left / evidence.left.max(f64::MIN_POSITIVE);
    (explained >= LEAST_EXPLAINED && share >= LEAST_SHARE).then_some(Wide {
        lamp,
        share,
        explained,
    })
}

/// Lights on the grid, in camera space.
fn lamps(receivers: &[SeenReceiver]) -> impl Iterator<Item = Lamp> + use<> {
    let camera_from_plane = receivers
        .first()
        .map(|receiver| receiver.plane_from_camera.inverse());
    camera_from_plane.into_iter().flat_map(|camera_from_plane| {
        let directions = ELEVATIONS_RAD.into_iter().flat_map(|elevation_rad: f64| {
            let (up, level) = elevation_rad.sin_cos();
            (0..N_AROUND).map(move |index| {
                let (z, x) = (TAU * index as f64 / N_AROUND as f64).sin_cos();
                DVec3::new(level * x, up, level * z)
            })
        });
        directions.flat_map(move |direction| {
            let direction = camera_from_plane.transform_vector3(direction).normalize();
            SPREADS.map(|spread| Lamp {
                direction,
                inverse_distance: 0.0,
                spread,
            })
        })
    })
}

/// The residual of a picture with one more light, and the light's share.
struct WithLamp {
    left: f64,
    share: f64,
}

/// The pixels, and the fit of ambient light to them.
struct Evidence<'a> {
    pixels: &'a [ReceiverPixel],
    /// The fraction of ambient light that the toy blocks at each pixel.
    taken: Vec<f64>,
    /// One over a variance of each channel of each pixel, less for outliers of ambient light.
    weights: Vec<[f64; 3]>,
    n_receivers: usize,
    /// Sum of its weighted squared residuals.
    left: f64,
}

impl<'a> Evidence<'a> {
    fn of(shadows: &'a Shadows<'_>) -> Self {
        let shaded = shadows.shaded(&[]);
        let weights = shaded.pixels.iter().map(|pixel| pixel.precision.map(f64::from));
        let mut evidence = Self {
            pixels: shaded.pixels,
            taken: shaded.ambient.iter().map(|taken| f64::from(taken[0])).collect(),
            weights: weights.collect(),
            n_receivers: shadows.caster.receivers.len(),
            left: 0.0,
        };
        for _ in 0..N_ROUNDS {
            evidence.reweight();
        }
        // With the same weights as for lamps.
        let fits = evidence.fits(|pixel| [1.0, -evidence.taken[pixel], 0.0], [1.0, 0.0]);
        evidence.left = fits.iter().map(|fit| fit.left).sum();
        evidence
    }

    /// Fits ambient light of any strength, and weights pixels by the residual.
    fn reweight(&mut self) {
        let model = |pixel: usize| [1.0, -self.taken[pixel], 0.0];
        let fits = self.fits(model, [1.0, 0.0]);
        let weight = |pixel: usize, channel: usize| {
            let seen = &self.pixels[pixel];
            let shown = Vector3::from(model(pixel)).dot(&fits[3 * seen.receiver + channel].factors);
            let residual = f64::from(seen.frame[channel]) - f64::from(seen.plate[channel]) * shown;
            let precision = f64::from(seen.precision[channel]);
            precision * robust::weight(residual * residual * precision / (ROBUST_FAR * ROBUST_FAR))
        };
        let weights = (0..self.pixels.len()).map(|pixel| [0, 1, 2].map(|channel| weight(pixel, channel)));
        self.weights = weights.collect();
    }

    /// Fits a lamp and ambient light like the pipeline; the lamp is given by the light that the toy
    /// blocks.
    fn with(&self, taken: &[f32]) -> WithLamp {
        let model = |pixel: usize| {
            let around = self.taken[pixel];
            [
                1.0 - around,
                around * (1.0 - around),
                around - f64::from(taken[pixel]),
            ]
        };
        let fits = self.fits(model, [1.0, MOST_SHARE]);
        let shares = fits.iter().take(3).map(|fit| fit.factors[2] / fit.factors[0]);
        WithLamp {
            left: fits.iter().map(|fit| fit.left).sum(),
            share: shares.sum::<f64>() / 3.0,
        }
    }

    /// Fits each channel of each receiver: its light over the plate is a gain times the first
    /// column and fractions of the others, which are between 0 and their maxima.
    fn fits(&self, columns: impl Fn(usize) -> [f64; 3], most: [f64; 2]) -> Vec<Fit> {
        let mut sums = vec![Sums::default(); 3 * self.n_receivers];
        for (index, (pixel, weights)) in self.pixels.iter().zip(&self.weights).enumerate() {
            let columns = Vector3::from(columns(index));
            for channel in 0..3 {
                let row = columns * f64::from(pixel.plate[channel]);
                let sums = &mut sums[3 * pixel.receiver + channel];
                sums.add(&row, f64::from(pixel.frame[channel]), weights[channel]);
            }
        }
        sums.iter().map(|sums| sums.fit(most)).collect()
    }
}

/// Factors of three columns, and the sum of weighted squared residuals.
struct Fit {
    factors: Vector3<f64>,
    left: f64,
}

/// Sums of weighted least squares.
#[derive(Clone, Default)]
struct Sums {
    normal: Matrix3<f64>,
    side: Vector3<f64>,
    squares: f64,
}

impl Sums {
    fn add(&mut self, row: &Vector3<f64>, value: f64, weight: f64) {
        self.normal.ger(weight, row, row, 1.0);
        self.side.axpy(weight * value, row, 1.0);
        self.squares += weight * value * value;
    }

    /// The best factors, with the second and the third between 0 and `most` of the first: for every
    /// combination of active bounds, the others are solved for.
    fn fit(&self, most: [f64; 2]) -> Fit {
        let states = [Held::No, Held::At(0.0), Held::At(1.0)];
        let ways = states.iter().flat_map(|a| states.iter().map(move |b| [*a, *b]));
        let fits = ways.filter_map(|way| self.held([way[0].of(most[0]), way[1].of(most[1])], most));
        let none = Fit {
            factors: Vector3::new(1.0, 0.0, 0.0),
            left: self.squares,
        };
        fits.min_by(|a, b| a.left.total_cmp(&b.left)).unwrap_or(none)
    }

    /// The best factors with some fixed at a fraction of the first; `None` if another violates its
    /// bounds.
    fn held(&self, parts: [Held; 2], most: [f64; 2]) -> Option<Fit> {
        // Maps the free unknowns to the factors.
        let mut spanned = Matrix3::zeros();
        spanned[(0, 0)] = 1.0;
        let mut normal = Matrix3::identity() * PRIOR;
        for (column, part) in (1..).zip(parts) {
            match part {
                Held::No => spanned[(column, column)] = 1.0,
                Held::At(part) => {
                    spanned[(column, 0)] = part;
                    normal[(column, column)] = 1.0;
                }
            }
        }
        normal += spanned.transpose() * self.normal * spanned;
        let unknowns = normal.cholesky()?.solve(&(spanned.transpose() * self.side));
        let factors = spanned * unknowns;
        let is_within = |column: usize| (0.0..=most[column - 1] * factors[0]).contains(&factors[column]);
        let is_held = |column: usize| matches!(parts[column - 1], Held::At(_));
        let is_allowed = factors[0] > 0.0 && (1..3).all(|column| is_held(column) || is_within(column));
        is_allowed.then(|| Fit {
            left: self.squares - 2.0 * factors.dot(&self.side) + factors.dot(&(self.normal * factors)),
            factors,
        })
    }
}

/// Whether a factor is fixed, and at which fraction of the first.
#[derive(Clone, Copy)]
enum Held {
    No,
    At(f64),
}

impl Held {
    fn of(self, most: f64) -> Self {
        match self {
            Self::No => Self::No,
            Self::At(part) => Self::At(part * most),
        }
    }
}
