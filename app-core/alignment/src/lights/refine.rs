//! Refines counted lamps in a larger picture.

use super::evidence::doubtful;
use super::lamp::{INVERSE_DISTANCE, Lamp, N_PARTS};
use super::prior::Prior;
use super::shading::Shading;
use super::shadows::{ROBUST_NEAR, Shadows, WIDE_PENUMBRA_PX};
use crate::raster::Rasterizer;
use crate::report::PoseDeviation;

/// Largest number of rounds in one picture.
const N_ROUNDS: usize = 3;
/// Significance of an inverse distance, in standard deviations; without a plate, a receiver's own
/// colours resemble the falloff of a lamp's light.
///
/// Measured without: the sun at 3.5 in a real room, bulbs at 9 and more.
const SIGNIFICANT: f64 = 3.0;
const SIGNIFICANT_WITHOUT_PLATE: f64 = 6.0;

/// An estimated lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredLight {
    pub(super) lamp: Lamp,
    /// Share of the light on the receiver nearest to the toy.
    pub(super) share: f64,
    /// Standard deviations of its parameters.
    pub(super) deviations: [f64; N_PARTS],
}

/// Lamps in a picture.
pub(super) struct Refined<'a> {
    pub(super) shadows: Shadows<'a>,
    pub(super) lamps: Vec<Lamp>,
}

impl Refined<'_> {
    /// Optimises the lamps, without those that prove to be none.
    pub(super) fn refine(&mut self, raster: &mut Rasterizer) {
        let shading = self.shading(raster);
        self.shadows.light(&self.lamps, &shading);
        let radius_m = self.shadows.caster.shape.radius_m;
        while !self.lamps.is_empty() {
            let priors: Vec<Prior> = self
                .lamps
                .iter()
                .map(|lamp| Prior::free(lamp, radius_m))
                .collect();
            // Unconstrained lamps stay.
            let _ = self
                .shadows
                .rounds(raster, (&mut self.lamps, &priors), (N_ROUNDS, ROBUST_NEAR));
            let shading = self.shading(raster);
            match doubtful(&self.lamps, &shading, &self.shadows) {
                Some(index) => drop(self.lamps.remove(index)),
                None => break,
            }
        }
    }

    /// Whether a larger picture adds no information.
    pub(super) fn is_wide(&self) -> bool {
        let mut lamps = self.lamps.iter();
        lamps.all(|lamp| self.shadows.penumbra_px(lamp) > WIDE_PENUMBRA_PX)
    }

    /// The lamps with their uncertainty. Lamps of unconstrained distance are moved to infinity.
    pub(super) fn measured(mut self, raster: &mut Rasterizer, pose: &PoseDeviation) -> Vec<MeasuredLight> {
        let radius_m = self.shadows.caster.shape.radius_m;
        let significance = if self.shadows.has_plate {
            SIGNIFICANT
        } else {
            SIGNIFICANT_WITHOUT_PLATE
        };
        let deviations = self.deviations(raster, pose);
        let far: Vec<bool> = self
            .lamps
            .iter()
            .zip(&deviations)
            .map(|(lamp, deviations)| lamp.inverse_distance < significance * deviations[INVERSE_DISTANCE])
            .collect();
        for (lamp, _) in self.lamps.iter_mut().zip(&far).filter(|(_, far)| **far) {
            lamp.inverse_distance = 0.0;
        }
        if far.contains(&true) {
            let priors = self.lamps.iter().map(|lamp| {
                if lamp.is_far() {
                    Prior::far(lamp)
                } else {
                    Prior::free(lamp, radius_m)
                }
            });
            let priors: Vec<Prior> = priors.collect();
            let _ = self
                .shadows
                .rounds(raster, (&mut self.lamps, &priors), (N_ROUNDS, ROBUST_NEAR));
        }
        let shading = self.shading(raster);
        let found = self.lamps.iter().zip(deviations).enumerate();
        found
            .map(|(index, (lamp, deviations))| MeasuredLight {
                lamp: *lamp,
                share: shading.share(0, index),
                deviations,
            })
            .collect()
    }

    fn deviations(&self, raster: &mut Rasterizer, pose: &PoseDeviation) -> Vec<[f64; N_PARTS]> {
        let covariance = self.shadows.covariance(raster, &self.lamps, pose, ROBUST_NEAR);
        (0..self.lamps.len())
            .map(|lamp| {
                [0, 1, 2, 3].map(|part| {
                    let place = N_PARTS * lamp + part;
                    covariance.as_ref().map_or(f64::INFINITY, |covariance| {
                        covariance[(place, place)].max(0.0).sqrt()
                    })
                })
            })
            .collect()
    }

    fn shading(&self, raster: &mut Rasterizer) -> Shading {
        self.shadows.shading(raster, &self.lamps, ROBUST_NEAR)
    }
}
