//! Estimates the pose of a toy that rests on a receiver from a distant start: a ghost that was
//! dropped by hand is centimetres and tens of degrees away, but upright and on its plane.
//!
//! With six degrees of freedom the coarse rounds would tilt such a toy until some outline fits. So
//! these rounds keep it on the plane, with one turn about the normal and two shifts, from several
//! turns, and from several places if it may be far away; only the best results are then optimised
//! freely.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, IVec2};

use super::motion::Held;
use super::placement::Placement;
use super::{Found, Search, Subject};
use crate::picture::Pyramid;
use crate::rigid_motion::RigidMotion;
use app_scene::scene::PoseUncertainty;

/// Spacing of the initial turns about the normal, and the largest of them if the uncertainty is not
/// stated.
const TURN_RAD: f64 = PI / 12.0;
const MOST_TURN_RAD: f64 = PI / 4.0;
/// Spacing of the initial places, over the toy's radius; only the given place if the uncertainty is
/// not stated.
const SHIFT: f64 = 0.4;
/// Largest number of initial places in each direction.
const MOST_SHIFTS: i32 = 4;
/// Number of starts that are followed through all rounds: the best after the first rounds.
const N_FOLLOWED: usize = 7;
const N_FIRST_ROUNDS: usize = 4;
/// Number of repetitions of the coarse rounds, each with the full reach.
const N_ROUNDS: usize = 2;
/// Number of starts that are then optimised freely.
const N_FREED: usize = 2;

/// Estimates the pose, starting from a subject's, which rests on a plane of that normal; `None` if
/// too little of the outline is visible.
pub(crate) fn find_resting(
    subject: Subject<'_>,
    pyramid: &Pyramid,
    normal: DVec3,
    uncertainty: &PoseUncertainty,
) -> Option<Found> {
    let shape = subject.shape;
    let mut search = Search::new(shape, pyramid, uncertainty);
    let start = RigidMotion::none(shape.centre, shape.radius_m);
    let given = search.fit(&Placement::of(start))?;
    let held = Held::to_plane(normal);
    let mut starts: Vec<(f64, RigidMotion)> = Vec::new();
    for mut motion in search.followed(&start, &held) {
        for _ in 0..N_ROUNDS {
            motion = search.coarse(motion, Some(&held));
        }
        if let Some(fit) = search.fit(&Placement::of(motion)) {
            starts.push((fit.wide_loss_px2, motion));
        }
    }
    starts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let freed = starts.iter().take(N_FREED);
    let freed = freed.filter_map(|(_, motion)| search.freed(subject, given, *motion));
    freed.max_by(|a, b| a.evidence.total_cmp(&b.evidence))
}

impl Search<'_> {
    /// The best starts; all of them, if they are few.
    fn followed(&mut self, start: &RigidMotion, held: &Held) -> Vec<RigidMotion> {
        let radius_m = self.shape.radius_m;
        let turns: Vec<f64> = turns(self.uncertainty.rotation_rad.unwrap_or(MOST_TURN_RAD)).collect();
        let shifts = shifts(self.uncertainty.position_m.unwrap_or(0.0), SHIFT * radius_m);
        let starts = shifts.flat_map(|shift| {
            let shifted = start.then(&held.shift(shift));
            let turned = turns.iter().map(move |turn| held.turn(*turn, radius_m));
            turned.map(move |turn| shifted.then(&turn))
        });
        let starts: Vec<RigidMotion> = starts.collect();
        if starts.len() <= N_FOLLOWED {
            return starts;
        }
        let mut ranked: Vec<(f64, RigidMotion)> = Vec::new();
        for start in starts {
            let motion = self.by_lines(start, Some(held), &Self::COARSE[..N_FIRST_ROUNDS]);
            if let Some(fit) = self.fit(&Placement::of(motion)) {
                ranked.push((fit.wide_loss_px2, motion));
            }
        }
        ranked.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let best = ranked.into_iter().take(N_FOLLOWED);
        best.map(|(_, motion)| motion).collect()
    }
}

/// Zero, and more to either side; each once, up to half a turn.
fn turns(most_rad: f64) -> impl Iterator<Item = f64> {
    #[allow(clippy::cast_possible_truncation, reason = "a dozen at most")]
    let n = (most_rad.min(PI) / TURN_RAD).round() as i32;
    let turns = (1..=n).flat_map(|step| [f64::from(step), -f64::from(step)]);
    let is_all_round = f64::from(n) * TURN_RAD > PI - 0.5 * TURN_RAD;
    let n_turns = if is_all_round { 2 * n - 1 } else { 2 * n };
    let turns = turns.take(n_turns.max(0) as usize);
    std::iter::once(0.0).chain(turns).map(|step| step * TURN_RAD)
}

/// Shifts on a disc of the given radius in metres, the centre first.
fn shifts(most_m: f64, apart_m: f64) -> impl Iterator<Item = DVec2> {
    #[allow(clippy::cast_possible_truncation, reason = "bounded")]
    let n = (most_m / apart_m).min(f64::from(MOST_SHIFTS)) as i32;
    let all = (-n..=n).flat_map(move |y| (-n..=n).map(move |x| IVec2::new(x, y)));
    let around = all.filter(move |at| *at != IVec2::ZERO && at.length_squared() <= n * n);
    std::iter::once(IVec2::ZERO)
        .chain(around)
        .map(move |at| apart_m * at.as_dvec2())
}
