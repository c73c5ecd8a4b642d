//! A minute of frames: errors and memory do not grow.

use glam::DVec3;

use super::case::{Case, Scope};
use super::exact::small;
use super::lab::{Lab, Label};
use super::row::{Bound, Findings, Sweep};
use crate::metrics::score;
use crate::photographer::world::{camera, toward};
use crate::photographer::{Films, Sensor, Shot, ToyFile, World};
use crate::process::held_mib;

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
/// Frames in all, and those of a round of the camera.
const N_FRAMES: usize = 1800;
const N_ROUND: usize = 60;

/// The group's cases.
pub(super) const CASES: &[Case] = &[Case::new("endurance", "orbit", Scope::Whole, orbit)];

/// A camera that goes to and fro, seen at a place of its round.
fn world_at(place: usize) -> World {
    #[allow(clippy::cast_precision_loss, reason = "a few dozen places")]
    let phase = std::f64::consts::TAU * place as f64 / N_ROUND as f64;
    let world = small();
    let target = DVec3::new(0.02, 0.04, 0.01);
    let eye = target + 0.44 * toward(30.0 + 6.0 * phase.cos(), 10.0 + 15.0 * phase.sin());
    World {
        camera: camera(world.size_px, eye, target),
        ..world
    }
}

/// Exposure of a frame: three slow waves over the whole run.
fn exposure_of(frame: usize) -> f64 {
    #[allow(clippy::cast_precision_loss, reason = "a few thousand frames")]
    let phase = std::f64::consts::TAU * 3.0 * frame as f64 / N_FRAMES as f64;
    1.0 + 0.2 * phase.sin()
}

fn orbit(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let films: Vec<(World, Films)> = (0..N_ROUND)
        .map(|place| {
            let world = world_at(place);
            let films = Films::of(&world);
            (world, films)
        })
        .collect();
    let (mut toys, mut shadows, mut held) = (Vec::new(), Vec::new(), Vec::new());
    for round in 0..N_FRAMES / N_ROUND {
        let mut sums = [0.0; 2];
        for (place, (world, films)) in films.iter().enumerate() {
            let frame = round * N_ROUND + place;
            let sensor = Sensor {
                frame_gain: DVec3::splat(exposure_of(frame)),
                ..Sensor::default()
            };
            let shot = Shot::told(world, &films.develop(&sensor), &ToyFile::default())?;
            let picture = if frame == 0 {
                lab.picture(&shot)?
            } else {
                lab.next(&shot.input)?
            };
            let scores = score(&picture, &shot.truth)?;
            sums[0] += scores.toy.rmse;
            sums[1] += scores.shadow.rmse;
        }
        #[allow(clippy::cast_precision_loss, reason = "a few dozen rounds")]
        let (at, n) = (round as f64, N_ROUND as f64);
        toys.push([at, sums[0] / n]);
        shadows.push([at, sums[1] / n]);
        held.push([at, held_mib()?]);
    }
    let last = toys.len() - 1;
    let growth = |points: &[[f64; 2]]| points[last][1] - points[1][1];
    let spoiled = if lab.is_planted() { 1e3 } else { 0.0 };
    let rows = vec![
        label.row("toy", DRIFT, growth(&toys) + spoiled),
        label.row("shadow", DRIFT, growth(&shadows) + spoiled),
        label.row("memory", GROWTH, growth(&held) + spoiled),
    ];
    let sweeps = vec![
        Sweep {
            name: "endurance-errors".to_owned(),
            along: "round of the camera",
            measure: "mean RMSE, codes",
            lines: vec![("toy", toys), ("shadow", shadows)],
        },
        Sweep {
            name: "endurance-memory".to_owned(),
            along: "round of the camera",
            measure: "memory held, MiB",
            lines: vec![("held", held)],
        },
    ];
    Ok(Findings { rows, sweeps })
}
