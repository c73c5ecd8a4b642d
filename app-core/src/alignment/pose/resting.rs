//! The pose of a toy that rests on a receiver, from farther off: a ghost that was dropped by hand is centimetres and tens of degrees away,
//! but upright and on its plane.
//!
//! With six freedoms the coarse rounds tilt such a toy until some outline fits. So these rounds hold it to the plane, one turn about the
//! normal and two shifts, from several turns; only what fits best is then freed.

use glam::DVec3;

use super::motion::{Held, Motion};
use super::{Found, Search};
use crate::alignment::picture::Pyramid;
use crate::alignment::shape::Shape;

/// Turns about the normal that are started from, in degrees.
const TURNS_DEG: [f64; 7] = [0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0];
/// Coarse rounds are gone through as often: each time they reach as far again.
const N_ROUNDS: usize = 2;
/// Of the starts, those that are freed.
const N_FREED: usize = 2;

/// Finds the pose, starting from that of `shape`, which rests on a plane of that normal; none where too little of the outline is seen.
pub(in crate::alignment) fn find_resting(shape: &Shape, pyramid: &Pyramid, normal: DVec3) -> Option<Found> {
    let mut search = Search::new(shape, pyramid);
    let start = Motion::none(shape.centre, shape.radius_m);
    let given = search.fit(&start)?;
    let held = Held::to_plane(normal);
    let mut starts: Vec<(f64, Motion)> = Vec::new();
    for turn_deg in TURNS_DEG {
        let mut motion = start.then(&held.turn(turn_deg.to_radians(), shape.radius_m));
        for _ in 0..N_ROUNDS {
            motion = search.coarse(motion, Some(&held));
        }
        if let Some(fit) = search.fit(&motion) {
            starts.push((fit.wide_loss_px2, motion));
        }
    }
    starts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let freed = starts.iter().take(N_FREED);
    let freed = freed.filter_map(|(_, motion)| search.freed(given, *motion));
    let outline_px = |found: &Found| found.found.outline_px();
    freed.min_by(|a, b| outline_px(a).total_cmp(&outline_px(b)))
}
