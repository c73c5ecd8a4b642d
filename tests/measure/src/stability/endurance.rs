//! Many frames: errors and memory do not grow.
//!
//! The process's memory is judged with `paper`, and with the model only on a graphics card:
//! lavapipe of Mesa 22.3 compiles uniform values that bound loops into a shader, for each frame,
//! and keeps all of these shaders until the pipeline is dropped. `toy` is such a shader; `paper`
//! has none.

use std::f64::consts::TAU;

use app_core::preset::Preset;
use glam::DVec3;

use super::case::{Case, Scope};
use super::exact::small;
use super::lab::{Lab, Label};
use super::row::{Bound, Findings, Row, Sweep};
use crate::heap::heap_mib;
use crate::photographer::world::{camera, toward};
use crate::photographer::{Films, Sensor, Shot, ToyFile, World};
use crate::process::held_mib;
use desk::metrics::score;

const DRIFT: Bound = Bound {
    limit: 0.25,
    unit: "codes",
    meaning: "mean RMSE of the last round, less that of the second",
};
const GROWTH: Bound = Bound {
    limit: 8.0,
    unit: "MiB",
    meaning: "memory held after the last round, less that after the second",
};
const HEAP_GROWTH: Bound = Bound {
    limit: 1.0,
    unit: "MiB",
    meaning: "heap of Rust code after the last round, less that after the second",
};
const MADE: Bound = Bound {
    limit: 0.0,
    unit: "objects",
    meaning: "made on the device after the second round, beside one a picture that is read",
};
const SAME_LIGHT: Bound = Bound {
    limit: 0.02,
    unit: "times",
    meaning: "largest deviation of gain, or of the light's intensity, from 1",
};
/// Waves of the exposure from the second round to the last, which both have the same exposures.
const N_WAVES: f64 = 3.0;
/// Noise that a planted fault adds to the photographs of each further round.
const PLANTED_NOISE_CODES: f64 = 12.0;
const GROUP: &str = "endurance";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "one-plate", Scope::Quick, one_plate),
    Case::new(GROUP, "orbit", Scope::Whole, |lab, label| {
        orbit(lab, label, &Rounds { n_places: 20, n: 6 })
    }),
    Case::new(GROUP, "orbit-minute", Scope::Named, |lab, label| {
        orbit(lab, label, &Rounds { n_places: 60, n: 30 })
    }),
];

/// Rounds of a camera that moves back and forth.
struct Rounds {
    /// Number of frames of each.
    n_places: usize,
    n: usize,
}

/// One round.
struct Round {
    /// Mean RMSE of the toy, and of the shadow.
    errors: [f64; 2],
    /// Number of objects created on the device up to its end, minus one per picture that was read.
    n_made: f64,
    heap_mib: f64,
    process_mib: f64,
}

impl Rounds {
    /// The world at a place of each round.
    fn world_at(&self, place: usize) -> World {
        let phase = TAU * place as f64 / self.n_places as f64;
        let world = small();
        let target = DVec3::new(0.02, 0.04, 0.01);
        let eye = target + 0.44 * toward(30.0 + 6.0 * phase.cos(), 10.0 + 15.0 * phase.sin());
        World {
            camera: camera(world.size_px, eye, target),
            ..world
        }
    }

    /// Exposure of a frame.
    fn exposure_of(&self, frame: usize) -> f64 {
        let n_frames = (self.n - 2) * self.n_places;
        let phase = TAU * N_WAVES * frame as f64 / n_frames as f64;
        1.0 + 0.2 * phase.sin()
    }

    fn films(&self) -> Vec<(World, Films)> {
        let worlds = (0..self.n_places).map(|place| self.world_at(place));
        worlds
            .map(|world| {
                let films = Films::of(&world);
                (world, films)
            })
            .collect()
    }

    /// The camera's picture at a place of a round.
    fn shot(&self, (world, films): &(World, Films), frame: usize, noise_codes: f64) -> anyhow::Result<Shot> {
        let sensor = Sensor {
            frame_gain: DVec3::splat(self.exposure_of(frame)),
            noise_codes,
            ..Sensor::default()
        };
        Ok(Shot::described(
            world,
            &films.develop(&sensor),
            &ToyFile::default(),
        )?)
    }

    fn run(&self, lab: &mut Lab, preset: Preset, places: &[(World, Films)]) -> anyhow::Result<Vec<Round>> {
        let mut rounds = Vec::with_capacity(self.n);
        for round in 0..self.n {
            let noise_codes = if lab.is_planted() {
                PLANTED_NOISE_CODES * round as f64
            } else {
                0.0
            };
            let mut errors = [0.0; 2];
            for (place, films) in places.iter().enumerate() {
                let frame = round * self.n_places + place;
                let shot = self.shot(films, frame, noise_codes)?;
                let picture = if frame == 0 {
                    lab.picture_by(preset, &shot)?
                } else {
                    lab.next(&shot.input)?
                };
                let scores = score(&picture, &shot.truth)?;
                errors[0] += scores.toy.rmse / self.n_places as f64;
                errors[1] += scores.shadow.rmse / self.n_places as f64;
            }
            rounds.push(Round {
                errors,
                n_made: lab.n_made() as f64 - ((round + 1) * self.n_places) as f64,
                heap_mib: heap_mib(),
                process_mib: held_mib()?,
            });
        }
        Ok(rounds)
    }
}

/// Away from the camera of the only plate and down; neither exposure nor light changes. Parts that
/// the plate does not show are estimated, each time from the estimate before.
fn one_plate(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let round = Rounds { n_places: 12, n: 1 };
    let (mut gains, mut intensities) = (Vec::new(), Vec::new());
    for place in 0..=round.n_places / 2 {
        let shot = Shot::of(&round.world_at(place))?;
        if place == 0 {
            lab.picture(&shot)?;
        } else {
            lab.next(&shot.input)?;
        }
        if let Some(fit) = lab.fit()? {
            gains.extend_from_slice(&fit.gain[..3]);
            intensities.extend_from_slice(&fit.intensity[0][..3]);
        }
    }
    let row = |what: &str, numbers: &[f32]| {
        let deviations = numbers.iter().map(|number| (f64::from(*number) - 1.0).abs());
        // NaN counts as the largest.
        let worst = deviations.max_by(f64::total_cmp).unwrap_or(f64::NAN);
        label.row(what, SAME_LIGHT, worst)
    };
    Ok(vec![row("gain", &gains), row("intensity", &intensities)].into())
}

/// Growth of a number from the second round to the last.
fn growth(rounds: &[Round], number_of: fn(&Round) -> f64) -> f64 {
    rounds.last().map_or(f64::NAN, number_of) - rounds.get(1).map_or(f64::NAN, number_of)
}

fn orbit(lab: &mut Lab, label: Label, rounds: &Rounds) -> anyhow::Result<Findings> {
    let places = rounds.films();
    let of_model = rounds.run(lab, Preset::Balanced, &places)?;
    let of_paper = rounds.run(lab, Preset::Paper, &places)?;
    let mut rows = judged(label, "balanced", &of_model);
    rows.extend(judged(label, "paper", &of_paper).split_off(2));
    rows.push(label.row(
        "paper, process",
        GROWTH,
        growth(&of_paper, |round| round.process_mib),
    ));
    let of_process = growth(&of_model, |round| round.process_mib);
    if lab.is_software() {
        rows[3].note = format!("the process grew by {of_process:.0} MiB, its driver among it");
    } else {
        rows.push(label.row("balanced, process", GROWTH, of_process));
    }
    Ok(Findings {
        rows,
        sweeps: sweeps(label, &of_model, &of_paper),
    })
}

/// Rows of toy, shadow, objects and heap.
fn judged(label: Label, preset: &str, rounds: &[Round]) -> Vec<Row> {
    let row = |what: &str, bound, number_of| {
        label.row(format!("{preset}, {what}"), bound, growth(rounds, number_of))
    };
    vec![
        row("toy", DRIFT, |round| round.errors[0]),
        row("shadow", DRIFT, |round| round.errors[1]),
        row("objects", MADE, |round| round.n_made),
        row("heap", HEAP_GROWTH, |round| round.heap_mib),
    ]
}

fn sweeps(label: Label, of_model: &[Round], of_paper: &[Round]) -> Vec<Sweep> {
    let points = |rounds: &[Round], number_of: fn(&Round) -> f64| -> Vec<[f64; 2]> {
        let numbers = rounds.iter().map(number_of);
        (0u16..)
            .map(f64::from)
            .zip(numbers)
            .map(|(at, number)| [at, number])
            .collect()
    };
    let sweep = |what: &str, measure, lines| Sweep {
        name: format!("endurance-{}-{what}", label.case),
        along: "round of the camera",
        measure,
        lines,
    };
    let errors = vec![
        ("toy", points(of_model, |round| round.errors[0])),
        ("shadow", points(of_model, |round| round.errors[1])),
    ];
    let held = vec![
        ("heap, balanced", points(of_model, |round| round.heap_mib)),
        ("heap, paper", points(of_paper, |round| round.heap_mib)),
        ("process, balanced", points(of_model, |round| round.process_mib)),
        ("process, paper", points(of_paper, |round| round.process_mib)),
    ];
    vec![
        sweep("errors", "mean RMSE, codes", errors),
        sweep("memory", "held, MiB", held),
    ]
}
