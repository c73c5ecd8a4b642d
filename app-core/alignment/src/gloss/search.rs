//! Roughness and strengths by which least is left unexplained.

use app_scene::gloss::N_GLOSSES;

use super::look::Look;
use super::solve::{Columns, Glossy, loss};

/// Where the search starts: slopes of facets from those of a glaze to those of a sheen.
const ROUGHNESSES: [f64; 8] = [0.03, 0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45];
const STRENGTHS: [f64; 3] = [0.5, 1.0, 1.8];
/// Factors of the steps that refine both.
const STRENGTH_STEPS: [f64; 2] = [0.8, 1.25];
const ROUGHNESS_STEPS: [f64; 2] = [0.85, 1.18];
const ROUGHNESS_RANGE: std::ops::RangeInclusive<f64> = 0.02..=0.6;
const STRENGTH_RANGE: std::ops::RangeInclusive<f64> = 0.05..=4.0;
/// And those that a material's own strength is tried at.
const OWN_STEPS: [f64; 5] = [0.0, 0.3, 0.7, 1.4, 2.0];
/// Part of the loss that a material's own strength must take.
const OWN_GAIN: f64 = 0.02;
/// Part of the samples that a material needs for that.
const OWN_PART: f64 = 0.03;
/// A step that gains less is none.
const LEAST_STEP: f64 = 1e-4;
/// Rounds over all numbers.
const N_ROUNDS: usize = 2;

/// The best of all that was tried.
pub(super) struct Found {
    pub(super) roughness: f64,
    /// Of each material.
    pub(super) strengths: Vec<f64>,
    /// Part of the loss of a matt toy that goes.
    pub(super) fall: f64,
}

/// What explains a look better than a matt toy, by that part of the loss; else none.
pub(super) fn found(look: &Look, least_fall: f64) -> Option<Found> {
    let matt = Trial::new(look, ROUGHNESSES[0], [0.0; N_GLOSSES]);
    let mut best = matt.clone();
    for roughness in ROUGHNESSES {
        let reflected = look.reflected(roughness);
        for strength in STRENGTHS {
            best.take_if_better(Trial::of(look, &reflected, (roughness, [strength; N_GLOSSES])), LEAST_STEP);
        }
    }
    // What follows gains little more.
    if best.loss > (1.0 - 0.7 * least_fall) * matt.loss {
        return None;
    }
    for _ in 0..N_ROUNDS {
        best.scale_strengths(look);
        best.part_materials(look);
        best.scale_roughness(look);
    }
    let fall = 1.0 - best.loss / matt.loss;
    (fall > least_fall).then(|| Found {
        roughness: best.roughness,
        strengths: best.strengths[..look.n_materials].to_vec(),
        fall,
    })
}

#[derive(Clone)]
struct Trial {
    roughness: f64,
    strengths: [f64; N_GLOSSES],
    loss: f64,
    reflected: Vec<Columns>,
}

impl Trial {
    fn new(look: &Look, roughness: f64, strengths: [f64; N_GLOSSES]) -> Self {
        Self::of(look, &look.reflected(roughness), (roughness, strengths))
    }

    fn of(look: &Look, reflected: &[Columns], (roughness, strengths): (f64, [f64; N_GLOSSES])) -> Self {
        Self {
            roughness,
            strengths,
            loss: loss(look, &Glossy { reflected, strengths }),
            reflected: reflected.to_vec(),
        }
    }

    fn take_if_better(&mut self, other: Self, least: f64) -> bool {
        let is_better = other.loss < self.loss - least;
        if is_better {
            *self = other;
        }
        is_better
    }

    fn with_strengths(&self, look: &Look, strengths: [f64; N_GLOSSES]) -> Self {
        Self::of(look, &self.reflected, (self.roughness, strengths))
    }

    fn scale_strengths(&mut self, look: &Look) {
        for step in STRENGTH_STEPS {
            loop {
                let scaled = self.strengths.map(|strength| step * strength);
                let is_possible = scaled.iter().all(|strength| *strength == 0.0 || STRENGTH_RANGE.contains(strength));
                if !is_possible || !self.take_if_better(self.with_strengths(look, scaled), LEAST_STEP) {
                    break;
                }
            }
        }
    }

    fn scale_roughness(&mut self, look: &Look) {
        for step in ROUGHNESS_STEPS {
            while ROUGHNESS_RANGE.contains(&(step * self.roughness)) {
                let trial = Self::new(look, step * self.roughness, self.strengths);
                if !self.take_if_better(trial, LEAST_STEP) {
                    break;
                }
            }
        }
    }

    /// Gives materials strengths of their own, the one first that tells most of it.
    fn part_materials(&mut self, look: &Look) {
        for _ in 0..look.n_materials {
            let mut best = self.clone();
            for (material, strength) in self.own_strengths(look) {
                let mut strengths = self.strengths;
                strengths[material] = strength;
                best.take_if_better(self.with_strengths(look, strengths), LEAST_STEP);
            }
            let least = OWN_GAIN * self.loss;
            if !self.take_if_better(best, least) {
                break;
            }
        }
    }

    /// Those that are tried, of materials that are large enough to tell.
    fn own_strengths(&self, look: &Look) -> Vec<(usize, f64)> {
        let least = OWN_PART * look.len() as f64;
        let count = |material: usize| look.samples.iter().filter(|sample| sample.material == material).count();
        let common = self.strengths[..look.n_materials].iter().copied().fold(0.0, f64::max);
        let large = (0..look.n_materials).filter(|material| count(*material) as f64 >= least);
        let tried = large.flat_map(|material| {
            let now = self.strengths[material];
            let from = if now > 0.0 { now } else { common };
            OWN_STEPS.map(|step| (material, step * from))
        });
        tried.filter(|(_, strength)| strength <= STRENGTH_RANGE.end()).collect()
    }
}
