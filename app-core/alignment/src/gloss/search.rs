//! Search for the roughness and the strengths with the smallest residual.

use std::rc::Rc;

use app_scene::gloss::N_GLOSSES;

use super::columns::{Columns, N_COLUMNS};
use super::look::Look;
use super::solve::{Glossy, loss};

/// Start values of the search: slopes of facets of a glaze, of satin and of a sheen.
const STARTS: [f64; 3] = [0.05, 0.12, 0.24];
const STRENGTHS: [f64; 3] = [0.5, 1.0, 1.8];
/// Values of the roughness that are tried with the estimated strengths.
const ROUGHNESSES: [f64; 8] = [0.03, 0.05, 0.08, 0.12, 0.17, 0.24, 0.33, 0.45];
/// Factors of the steps that refine both.
const STRENGTH_STEPS: [f64; 2] = [0.8, 1.25];
const ROUGHNESS_STEPS: [f64; 2] = [0.85, 1.18];
const ROUGHNESS_RANGE: std::ops::RangeInclusive<f64> = 0.02..=0.6;
const STRENGTH_RANGE: std::ops::RangeInclusive<f64> = 0.05..=4.0;
/// Factors at which a material's own strength is tried.
const OWN_STEPS: &[f64] = &[0.0, 0.3, 0.7, 1.4, 2.0];
/// Factor of a matt material among others.
const OFF: &[f64] = &[0.0];
/// Share of the loss that a material's own strength must explain.
const OWN_GAIN: f64 = 0.02;
/// Share of the samples that a material needs for a strength of its own.
const OWN_PART: f64 = 0.03;
/// Smallest gain of a step that is accepted.
const LEAST_STEP: f64 = 1e-4;
/// Rounds over all numbers.
const N_ROUNDS: usize = 2;
/// Factors of all strengths that are tried for a toy without highlights.
const WITHOUT_HIGHLIGHTS: [f64; 3] = [0.6, 1.0, 1.5];

/// The best result of the search.
pub(super) struct Found {
    pub(super) roughness: f64,
    /// Strength of each material.
    pub(super) strengths: Vec<f64>,
    /// Relative fall of the loss against a matt toy.
    pub(super) fall: f64,
    /// Share of the fall due to lamps' highlights, which alone constrain the roughness.
    pub(super) of_highlights: f64,
}

/// The best explanation of a look, if its loss is lower than a matt toy's by that share.
pub(super) fn found(look: &Look, least_fall: f64) -> Option<Found> {
    let matt = Trial::new(look, STARTS[0], [0.0; N_GLOSSES]);
    // The later steps gain little more.
    let most = (1.0 - 0.7 * least_fall) * matt.loss;
    let starts = STARTS.map(|roughness| Trial::best_at(look, roughness));
    let mut promising: Vec<Trial> = starts.into_iter().filter(|start| start.loss < most).collect();
    promising
        .iter_mut()
        .for_each(|start| start.part_materials(look, OFF));
    let mut best = promising
        .into_iter()
        .min_by(|a, b| a.with_freedoms().total_cmp(&b.with_freedoms()))?;
    for _ in 0..N_ROUNDS {
        for roughness in ROUGHNESSES {
            best.take_if_better(Trial::new(look, roughness, best.strengths), LEAST_STEP);
        }
        best.scale_strengths(look);
        best.part_materials(look, OWN_STEPS);
        best.scale_roughness(look);
    }
    let fall = 1.0 - best.loss / matt.loss;
    (fall > least_fall).then(|| Found {
        of_highlights: (best.without_highlights(look) - best.loss) / matt.loss,
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
    /// Shared by trials of the same roughness.
    reflected: Rc<[Columns]>,
}

impl Trial {
    fn new(look: &Look, roughness: f64, strengths: [f64; N_GLOSSES]) -> Self {
        Self::of(look, look.reflected(roughness).into(), (roughness, strengths))
    }

    fn of(look: &Look, reflected: Rc<[Columns]>, (roughness, strengths): (f64, [f64; N_GLOSSES])) -> Self {
        Self {
            roughness,
            strengths,
            loss: loss(
                look,
                &Glossy {
                    reflected: &reflected,
                    strengths,
                },
            ),
            reflected,
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
        Self::of(look, Rc::clone(&self.reflected), (self.roughness, strengths))
    }

    fn scale_strengths(&mut self, look: &Look) {
        for step in STRENGTH_STEPS {
            loop {
                let scaled = self.strengths.map(|strength| step * strength);
                let is_possible = scaled
                    .iter()
                    .all(|strength| *strength == 0.0 || STRENGTH_RANGE.contains(strength));
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

    /// The best uniform gloss at a roughness.
    fn best_at(look: &Look, roughness: f64) -> Self {
        let reflected: Rc<[Columns]> = look.reflected(roughness).into();
        let [first, rest @ ..] = STRENGTHS
            .map(|strength| Self::of(look, Rc::clone(&reflected), (roughness, [strength; N_GLOSSES])));
        let mut best = first;
        for other in rest {
            best.take_if_better(other, LEAST_STEP);
        }
        best
    }

    /// The loss, with a penalty for matt materials among others.
    fn with_freedoms(&self) -> f64 {
        let n_off = self.strengths.iter().filter(|strength| **strength == 0.0).count();
        self.loss * (1.0 + OWN_GAIN * n_off as f64)
    }

    /// The smallest loss if lamps had no highlights.
    fn without_highlights(&self, look: &Look) -> f64 {
        let mut least = f64::INFINITY;
        for roughness in STARTS {
            let mut reflected = look.reflected(roughness);
            reflected
                .iter_mut()
                .for_each(|columns| columns.rows_mut(2, N_COLUMNS - 2).fill(0.0));
            let reflected: Rc<[Columns]> = reflected.into();
            for factor in WITHOUT_HIGHLIGHTS {
                let strengths = self.strengths.map(|strength| factor * strength);
                least = least.min(Self::of(look, Rc::clone(&reflected), (roughness, strengths)).loss);
            }
        }
        least
    }

    /// Gives materials strengths of their own, the most effective one first.
    fn part_materials(&mut self, look: &Look, steps: &[f64]) {
        for _ in 0..look.n_materials {
            let mut best = self.clone();
            for (material, strength) in self.own_strengths(look, steps) {
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

    /// Candidate strengths for materials that are large enough.
    fn own_strengths(&self, look: &Look, steps: &[f64]) -> Vec<(usize, f64)> {
        let least = OWN_PART * look.len() as f64;
        let count = |material: usize| {
            let samples = look.samples.iter();
            samples.filter(|sample| sample.material == material).count()
        };
        let own = &self.strengths[..look.n_materials];
        let common = own.iter().copied().fold(0.0, f64::max);
        let large = (0..look.n_materials).filter(|material| count(*material) as f64 >= least);
        let tried = large.flat_map(|material| {
            let now = own[material];
            let from = if now > 0.0 { now } else { common };
            steps.iter().map(move |step| (material, step * from))
        });
        let tried = tried.filter(|(material, strength)| *strength != own[*material]);
        tried
            .filter(|(_, strength)| strength <= STRENGTH_RANGE.end())
            .collect()
    }
}
