//! Possible directions of a light.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::cast::Caster;
use super::lamp::{Lamp, N_PARTS};

/// Number of directions over the hemisphere.
const N_DIRECTIONS: u32 = 240;
/// Sine of the lowest elevation in the search.
const LOWEST: f64 = 0.12;
/// Initial distance of a light of unknown distance, over the toy's radius.
const USUAL_DISTANCE: f64 = 10.0;

/// Largest distance of neighbours, in spacings.
const NEIGHBOURS: f64 = 1.8;
/// Number of turns of a lamp while climbing, with as many halvings.
const N_TURNS: usize = 8;
const N_HALVINGS: usize = 3;

/// Approximate angle between neighbouring directions, in radians.
fn spacing_rad() -> f64 {
    (TAU * (1.0 - LOWEST) / f64::from(N_DIRECTIONS)).sqrt()
}

/// A point light in a direction, in camera space.
pub(super) fn lamp_from(caster: &Caster<'_>, direction: DVec3) -> Lamp {
    Lamp {
        direction,
        inverse_distance: 1.0 / (USUAL_DISTANCE * caster.shape.radius_m),
        spread: 0.0,
    }
}

/// Point lights in all directions above the receiver nearest to the toy, evenly spread. Source:
/// Vogel 1979, on Lambert's cylinder.
pub(super) fn lamps(caster: &Caster<'_>) -> Vec<Lamp> {
    let Some(receiver) = caster.receivers.first() else {
        return Vec::new();
    };
    let camera_from_plane = receiver.plane_from_camera.inverse();
    let golden_angle_rad = PI * (3.0 - 5f64.sqrt());
    let lamp = |index: u32| {
        let part = (f64::from(index) + 0.5) / f64::from(N_DIRECTIONS);
        let up = LOWEST + (1.0 - LOWEST) * part;
        let (z, x) = (f64::from(index) * golden_angle_rad).sin_cos();
        let level = (1.0 - up * up).sqrt();
        let direction = camera_from_plane.transform_vector3(DVec3::new(level * x, up, level * z));
        lamp_from(caster, direction.normalize())
    };
    (0..N_DIRECTIONS).map(lamp).collect()
}

/// The lamps whose scores are local maxima, best first.
pub(super) fn peaks(lamps: &[Lamp], scores: &[f64]) -> Vec<Lamp> {
    let near = NEIGHBOURS * spacing_rad();
    let is_peak = |index: usize| {
        let others = lamps.iter().zip(scores);
        let mut near = others.filter(|(lamp, _)| lamp.direction.angle_between(lamps[index].direction) < near);
        scores[index] > 0.0 && near.all(|(_, score)| *score <= scores[index])
    };
    let mut peaks: Vec<usize> = (0..lamps.len()).filter(|index| is_peak(*index)).collect();
    peaks.sort_by(|a, b| scores[*b].total_cmp(&scores[*a]));
    peaks.into_iter().map(|index| lamps[index]).collect()
}

/// Turns a lamp to the best of the directions around it, in ever smaller steps; returns its score,
/// too.
pub(super) fn climb(from: &Lamp, mut score: impl FnMut(&Lamp) -> f64) -> (f64, Lamp) {
    let mut best = (score(from), *from);
    let mut by_rad = 0.5 * spacing_rad();
    for _ in 0..N_HALVINGS {
        let middle = best.1;
        for turn in 0..N_TURNS {
            let angle = TAU * turn as f64 / N_TURNS as f64;
            let at = by_rad * DVec2::from_angle(angle);
            let mut step = [0.0; N_PARTS];
            [step[0], step[1]] = at.to_array();
            let turned = middle.moved(&step);
            let scored = (score(&turned), turned);
            if scored.0 > best.0 {
                best = scored;
            }
        }
        by_rad *= 0.5;
    }
    best
}
