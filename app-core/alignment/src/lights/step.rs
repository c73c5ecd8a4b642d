//! Gauss-Newton steps of all lamps at once.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::lamp::{INVERSE_DISTANCE, Lamp, N_PARTS, SPREAD};
use super::prior::Prior;
use super::shading::{FIRST_LAMP, Factors, N_FACTORS, Normal, PRIOR, Shaded, Shading, add_outer};
use super::shadows::{LEAST_PENUMBRA_PX, Shadows};
use crate::raster::Rasterizer;

/// Length of differences, as a fraction of the penumbra: shorter ones fail on wide penumbrae, where
/// single samples would dominate.
const OF_PENUMBRA: f64 = 0.3;
/// Lower bound of that length, in pixels.
const LEAST_PX: f64 = 0.5;
/// The longest step of each parameter; of the spread as a fraction of it.
const LONGEST_RAD: f64 = 0.06;
/// The longest step of an inverse distance, as a fraction of the larger of itself and this, over
/// the toy's radius.
const LONGEST_NEARING: f64 = 0.2;
const USUAL_INVERSE_DISTANCE: f64 = 0.1;
const LONGEST_GROWTH: f64 = 1.0;
const LONGEST_SHRINKING: f64 = 0.5;
/// Smallest step of a spread.
const LEAST_GROWTH: f64 = 0.003;

/// Derivative of a lamp's blocked light by one of its parameters, at each pixel.
pub(super) type Slope = Option<Vec<f32>>;

impl Shadows<'_> {
    /// Moves all lamps by one step; returns the standard deviation of each direction. `None` if
    /// they are unconstrained.
    pub(super) fn step(
        &self,
        raster: &mut Rasterizer,
        lamps: &mut [Lamp],
        priors: &[Prior],
        robust: f64,
    ) -> Option<Vec<f64>> {
        let taken = self.taken_of_all(raster, lamps);
        let slopes: Vec<Slope> = lamps
            .iter()
            .zip(priors)
            .zip(&taken)
            .flat_map(|((lamp, prior), taken)| {
                // Without a plate the constraint is so weak that the error of one-sided differences
                // would exceed it.
                let here = (self.is_rough && self.has_plate).then_some(taken.as_slice());
                self.slopes(raster, (lamp, here), prior)
            })
            .collect();
        let shaded = self.shaded(&taken);
        let shading = shaded.fit(self.caster.receivers.len(), robust);
        let mut system = System::new(slopes.len(), shading.factors.len());
        self.gather(&mut system, &shaded, &shading, &slopes, robust);
        let (mut normal, mut side) = system.without_factors();
        for (index, (lamp, prior)) in lamps.iter().zip(priors).enumerate() {
            for (part, (away, information)) in prior.pull(lamp).into_iter().enumerate() {
                let place = N_PARTS * index + part;
                normal[(place, place)] += information;
                side[place] -= information * away;
            }
        }
        let factor = normal.cholesky()?;
        let step = factor.solve(&side);
        let covariance = factor.inverse();
        for (index, lamp) in lamps.iter_mut().enumerate() {
            let part = |part: usize| step[N_PARTS * index + part];
            let step = [part(0), part(1), part(2), part(3)];
            let moved = lamp.moved(&bounded(lamp, &priors[index], step, self.caster.shape.radius_m));
            *lamp = priors[index].within(moved);
        }
        let deviations = (0..lamps.len()).map(|index| {
            let variance = |part: usize| covariance[(N_PARTS * index + part, N_PARTS * index + part)];
            (variance(0) + variance(1)).max(0.0).sqrt()
        });
        Some(deviations.collect())
    }

    /// Derivatives of a lamp's blocked light; `None` for an unconstrained parameter. They are
    /// central, or one-sided from the value `here`, for half the work.
    pub(super) fn slopes(
        &self,
        raster: &mut Rasterizer,
        (lamp, here): (&Lamp, Option<&[f32]>),
        prior: &Prior,
    ) -> [Slope; N_PARTS] {
        let disc = self.disc(lamp);
        let penumbra_px = self.penumbra_px(lamp);
        let turn_rad = difference_px(penumbra_px) / self.px_per_rad;
        [0, 1, INVERSE_DISTANCE, SPREAD].map(|part| {
            let is_constrained = part != SPREAD || penumbra_px >= 0.999 * LEAST_PENUMBRA_PX;
            if !is_constrained || prior.holds(part) {
                return None;
            }
            // A lamp that comes nearer turns as seen from the toy's rim.
            let by = match part {
                INVERSE_DISTANCE => turn_rad / self.caster.shape.radius_m,
                _ => turn_rad,
            };
            let moved = |by: f64| {
                let mut step = [0.0; N_PARTS];
                step[part] = by;
                lamp.moved(&step)
            };
            let (more, less) = (moved(by), if here.is_some() { *lamp } else { moved(-by) });
            let span = match part {
                SPREAD => more.spread - less.spread,
                INVERSE_DISTANCE => more.inverse_distance - less.inverse_distance,
                _ if here.is_some() => by,
                _ => 2.0 * by,
            };
            let more = self.taken(raster, &more, &disc);
            let less = here.map_or_else(|| Cow::Owned(self.taken(raster, &less, &disc)), Cow::Borrowed);
            #[allow(clippy::cast_possible_truncation, reason = "a slope, to 7 digits")]
            let differences = more
                .iter()
                .zip(less.as_ref())
                .map(|(more, less)| (f64::from(more - less) / span) as f32);
            Some(differences.collect())
        })
    }

    fn gather(&self, system: &mut System, shaded: &Shaded, shading: &Shading, slopes: &[Slope], robust: f64) {
        let mut slope = vec![0.0; slopes.len()];
        for (index, pixel) in self.pixels.iter().enumerate() {
            let columns = shaded.columns(index);
            for (value, slope) in slope.iter_mut().zip(slopes) {
                *value = slope.as_ref().map_or(0.0, |slope| f64::from(slope[index]));
            }
            for channel in 0..3 {
                let factors = &shading.factors[pixel.receiver][channel];
                let Some(one) = shaded.residual((index, channel), &columns, factors, robust) else {
                    continue;
                };
                let plate = f64::from(pixel.plate[channel]);
                let of_lamps = slope.iter().enumerate();
                let of_lamps =
                    of_lamps.map(|(place, slope)| -plate * factors[FIRST_LAMP + place / N_PARTS] * slope);
                system.add(
                    3 * pixel.receiver + channel,
                    &one.row,
                    of_lamps,
                    (one.weight, one.residual),
                );
            }
        }
    }
}

/// Normal equations of lamps and factors; each receiver and channel has its own factors.
struct System {
    lamps: DMatrix<f64>,
    side: DVector<f64>,
    blocks: Vec<Block>,
    /// The lamps' part of a row, reused.
    row: DVector<f64>,
}

/// Normal equations of the factors of one channel of a receiver.
struct Block {
    factors: Normal,
    mixed: DMatrix<f64>,
    side: Factors,
}

impl System {
    fn new(n_parts: usize, n_receivers: usize) -> Self {
        let block = || Block {
            factors: Normal::identity() * PRIOR,
            mixed: DMatrix::zeros(N_FACTORS, n_parts),
            side: Factors::zeros(),
        };
        Self {
            lamps: DMatrix::zeros(n_parts, n_parts),
            side: DVector::zeros(n_parts),
            blocks: (0..3 * n_receivers).map(|_| block()).collect(),
            row: DVector::zeros(n_parts),
        }
    }

    fn add(
        &mut self,
        block: usize,
        factors: &Factors,
        lamps: impl Iterator<Item = f64>,
        (weight, residual): (f64, f64),
    ) {
        let block = &mut self.blocks[block];
        add_outer(&mut block.factors, factors, weight, N_FACTORS);
        block.side += factors * (weight * residual);
        let mut is_touched = false;
        for (value, part) in self.row.iter_mut().zip(lamps) {
            *value = part;
            is_touched |= part != 0.0;
        }
        if is_touched {
            self.lamps.ger(weight, &self.row, &self.row, 1.0);
            self.side.axpy(weight * residual, &self.row, 1.0);
            block.mixed.ger(weight, factors, &self.row, 1.0);
        }
    }

    /// The lamps' equations with all factors eliminated: Schur complements.
    fn without_factors(self) -> (DMatrix<f64>, DVector<f64>) {
        let (mut normal, mut side) = (self.lamps, self.side);
        for block in self.blocks {
            if let Some(factor) = block.factors.cholesky() {
                normal -= block.mixed.transpose() * factor.solve(&block.mixed);
                side -= block.mixed.transpose() * factor.solve(&block.side);
            }
        }
        (normal, side)
    }
}

/// Length of differences on either side, in pixels.
pub(super) fn difference_px(penumbra_px: f64) -> f64 {
    (OF_PENUMBRA * 0.5 * penumbra_px).max(LEAST_PX)
}

/// A step within the range in which the model is nearly linear; a near lamp stays near.
pub(super) fn bounded(lamp: &Lamp, prior: &Prior, step: [f64; N_PARTS], radius_m: f64) -> [f64; N_PARTS] {
    let growth = (LONGEST_GROWTH * lamp.spread).max(LEAST_GROWTH);
    let nearing = LONGEST_NEARING * lamp.inverse_distance.max(USUAL_INVERSE_DISTANCE / radius_m);
    let receding = if prior.is_near() {
        0.5 * lamp.inverse_distance
    } else {
        nearing
    };
    [
        step[0].clamp(-LONGEST_RAD, LONGEST_RAD),
        step[1].clamp(-LONGEST_RAD, LONGEST_RAD),
        step[INVERSE_DISTANCE].clamp(-receding.min(nearing), nearing),
        step[SPREAD].clamp(-LONGEST_SHRINKING * lamp.spread, growth),
    ]
}
