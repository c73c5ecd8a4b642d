//! Lights all around a box, compared with the truth.

use glam::DVec3;

use super::case::{Case, Scope};
use super::lab::{Lab, Label};
use super::row::{Bound, Findings, Sweep};
use crate::photographer::world::toward;
use crate::photographer::{Key, Lamp, Photos, Shot, Shown, Stance, ToyFile, World};
use desk::metrics::score;

const TOY: Bound = Bound {
    limit: 10.0,
    unit: "codes",
    meaning: "toy's RMSE against the truth",
};
const SHADOW: Bound = Bound {
    limit: 1.8,
    unit: "codes",
    meaning: "shadow's RMSE against the truth",
};
const BLACK: Bound = Bound {
    limit: 0.0,
    unit: "pixels",
    meaning: "black pixels on the toy that the truth does not have",
};
const SPIKE: Bound = Bound {
    limit: 5.0,
    unit: "%",
    meaning: "change of RMSE by a long clip around the motion",
};
/// Distance of the toy's jump in the long clip.
const ASIDE_M: DVec3 = DVec3::new(0.18, 0.0, 0.0);
/// Largest code of a black pixel.
const BLACK_CODE: u8 = 2;
const ELEVATIONS_DEG: [f64; 4] = [20.0, 40.0, 60.0, 80.0];
const GROUP: &str = "truth";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "round-quick", Scope::Quick, round_quick),
    Case::new(GROUP, "round", Scope::Whole, round),
    Case::new(GROUP, "long-clip", Scope::Quick, long_clip),
];

fn round_quick(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    sweep(lab, label, &[50.0], 180)
}

fn round(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    sweep(lab, label, &ELEVATIONS_DEG, 30)
}

fn sweep(lab: &mut Lab, label: Label, elevations_deg: &[f64], step_deg: usize) -> anyhow::Result<Findings> {
    let mut findings = Findings::default();
    for &elevation_deg in elevations_deg {
        let (mut toys, mut shadows) = (Vec::new(), Vec::new());
        for azimuth_deg in (0..360u16).step_by(step_deg).map(f64::from) {
            let bulb = Lamp::bulb(toward(elevation_deg, azimuth_deg), 0.01, 0.75);
            let shot = Shot::of(&World::boxes().lit_by(vec![bulb]))?;
            let picture = lab.picture(&shot)?;
            let scores = score(&picture, &shot.truth)?;
            toys.push([azimuth_deg, scores.toy.rmse]);
            shadows.push([azimuth_deg, scores.shadow.rmse]);
            let parameter = format!("elevation {elevation_deg}, azimuth {azimuth_deg} deg");
            findings.rows.extend([
                label.row(parameter.clone(), TOY, scores.toy.rmse),
                label.row(parameter.clone(), SHADOW, scores.shadow.rmse),
                label.row(parameter, BLACK, n_black(&picture, &shot)),
            ]);
        }
        findings.sweeps.push(Sweep {
            name: format!("{}-{elevation_deg}", label.case),
            along: "azimuth, degrees",
            measure: "RMSE, codes",
            lines: vec![("toy", toys), ("shadow", shadows)],
        });
    }
    Ok(findings)
}

fn n_black(picture: &app_core::scene::Image, shot: &Shot) -> f64 {
    let is_black = |pixel: &[u8]| pixel[..3].iter().all(|code| *code <= BLACK_CODE);
    let pixels = picture.rgba8.chunks_exact(4);
    let truth = shot.truth.image.rgba8.chunks_exact(4);
    let mask = shot.truth.mask.rgba8.chunks_exact(4);
    let black = pixels
        .zip(truth)
        .zip(mask)
        .filter(|((pixel, truth), mask)| mask[0] > 0 && is_black(pixel) && !is_black(truth));

    black.count() as f64
}

/// A toy that jumps aside at one moment of a clip, at the key of that number.
fn aside(key_secs: &[f64], aside_at: usize) -> World {
    let mut world = World::boxes();
    for part in &mut world.parts {
        let far = Stance::at(part.rest.place_m + ASIDE_M);
        let keys = key_secs.iter().enumerate();
        part.keys = keys
            .map(|(key, &time_secs)| Key {
                time_secs,
                stance: if key == aside_at { far } else { part.rest },
            })
            .collect();
    }
    world.shown = Shown::At {
        time_secs: key_secs[aside_at],
    };
    world
}

/// Shown at its largest distance: at the end of a clip of a second, and in the middle of a long
/// clip that moves for 0.8 s.
fn long_clip(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let plain = aside(&[0.0, 1.0], 1);
    let photos = Photos::of(&plain);
    let shot = Shot::described(&plain, &photos, &ToyFile::default())?;
    let before = score(&lab.reference(&shot)?, &shot.truth)?;
    let mut rows = Vec::new();
    for minutes in lab.some_of([0.1, 10.0, 1.0], 1) {
        let middle_secs = 30.0 * minutes;
        let keys = [
            0.0,
            middle_secs - 0.4,
            middle_secs,
            middle_secs + 0.4,
            60.0 * minutes,
        ];
        let long = aside(&keys, 2);
        let shot = Shot::described(&long, &photos, &ToyFile::default())?;
        let after = score(&lab.picture(&shot)?, &shot.truth)?;
        let regions = [
            ("toy", before.toy, after.toy),
            ("shadow", before.shadow, after.shadow),
        ];
        for (region, before, after) in regions {
            let change = 100.0 * (after.rmse / before.rmse - 1.0).abs();
            let row = label.row(format!("{minutes} min, {region}"), SPIKE, change);
            rows.push(row.noting(before.rmse, after.rmse));
        }
    }
    Ok(rows.into())
}
