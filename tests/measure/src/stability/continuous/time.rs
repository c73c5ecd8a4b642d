//! Time in a clip: the photographs stay, the shown moment changes.

use app_core::scene::Pose;
use glam::{DQuat, DVec3};

use super::{Moment, findings};
use crate::photographer::{CLIP, Key, Photos, Shot, Stance, ToyFile, World};
use crate::stability::exact::small;
use crate::stability::lab::{Lab, Label};
use crate::stability::row::{Bound, Findings};

const ONE_CODE: Bound = Bound {
    limit: 1.0,
    unit: "codes",
    meaning: "largest difference of a colour from that at a key",
};
/// Moments after a key: in the longest of them the toy's fastest point moves by less than a
/// ten-thousandth of a pixel.
const AFTER_SECS: [f64; 3] = [1e-9, 1e-7, 1e-6];
const N_STEPS: u32 = 64;

/// A clip that returns after half its time.
fn there_and_back() -> World {
    let mut world = small();
    for part in &mut world.parts {
        if let [from, to] = part.keys[..] {
            let key = |time_secs, key: Key| Key { time_secs, ..key };
            part.keys = vec![key(0.0, from), key(0.5, to), key(1.0, from)];
        }
    }
    world
}

/// Makes the same frame at one moment after another.
fn at_moments(lab: &mut Lab, world: &World, times_secs: &[f64]) -> anyhow::Result<Vec<Moment>> {
    let shot = Shot::described(world, &Photos::of(world), &ToyFile::default())?;
    let clip = shot.scene.toy.find_clip(CLIP)?;
    let mut moments = Vec::new();
    for (index, &time_secs) in times_secs.iter().enumerate() {
        let mut shot = shot.clone();
        shot.input.shown_pose = Pose::Clip { clip, time_secs };
        let made = if index == 0 {
            lab.picture(&shot)
        } else {
            lab.next(&shot.input)
        };
        moments.push(Moment {
            at: time_secs,
            made,
            truth: None,
            errors: None,
        });
    }
    Ok(moments)
}

pub(super) fn through_a_clip(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let times: Vec<f64> = (0..=N_STEPS).map(|i| f64::from(i) / f64::from(N_STEPS)).collect();
    let moments = at_moments(lab, &there_and_back(), &times)?;
    findings(label, "time, s", moments, None)
}

/// A clip in which a part stands still, then moves: a moment just after a key must not differ
/// visibly.
fn starts_late() -> World {
    let mut world = small();
    let rest = world.parts[1].rest;
    let end = Stance {
        place_m: rest.place_m + DVec3::new(0.0, 0.03, 0.0),
        turn: DQuat::from_rotation_x(0.8),
    };
    let key = |time_secs, stance| Key { time_secs, stance };
    world.parts[1].keys = vec![key(0.0, rest), key(0.25, rest), key(0.75, end), key(1.0, end)];
    world
}

pub(super) fn at_keys(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let mut all = Findings::default();
    let worlds = [
        ("one part starts late", starts_late()),
        ("there and back", there_and_back()),
    ];
    for (name, world) in worlds {
        for key in lab.some_of([0.25, 0.75, 0.5, 0.0], 1) {
            let times: Vec<f64> = [0.0]
                .into_iter()
                .chain(AFTER_SECS)
                .map(|after| key + after)
                .collect();
            let mut moments = at_moments(lab, &world, &times)?.into_iter();
            let Some(before) = moments.next() else {
                continue;
            };
            let before = before.made?;
            for (moment, after) in moments.zip(AFTER_SECS) {
                let parameter = format!("{name}: {after:e} s after {key} s");
                let row = label.against(parameter, ONE_CODE, (&before, moment.made), |gap| gap.max)?;
                all.rows.push(row);
            }
        }
    }
    Ok(all)
}
