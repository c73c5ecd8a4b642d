//! Outlines of things before the toy, in pixels of the largest level: things are found in one of fewer
//! pixels, where they end a pixel too early or too late.

use super::codes::{Codes, UNLIKE_CODES, from_shaded};
use super::found::Found;
use crate::picture::{index_in, places, square};
use app_scene::things::Mark;

/// Distance from a marked outline within which the plate's colours decide, in pixels of the level in
/// which things were found: its own pixels, and half of one for colours that two share.
const WITHIN_PX: f64 = 1.5;

/// The marks with the outlines of things before the toy where the plate's colours change. Frame and
/// plate are in codes; `per_px` are pixels of the level with things for one of theirs.
pub(super) fn sharpened(
    found: &Found<'_>,
    [frame, plate]: [&Codes; 2],
    per_px: f64,
    marks: &[Mark],
) -> Vec<Mark> {
    let size_px = plate.size_px;
    #[allow(clippy::cast_possible_truncation, reason = "a few pixels")]
    let within_px = (WITHIN_PX / per_px).round() as i32;
    let is_before = |at| index_in(size_px, at).map(|index| marks[index] == Mark::BeforeToy);
    let mut is_near = vec![false; marks.len()];
    for at in places(size_px).filter(|at| is_before(*at) == Some(true)) {
        if square(at, 1).any(|at| is_before(at) == Some(false)) {
            for index in square(at, within_px).filter_map(|at| index_in(size_px, at)) {
                is_near[index] = true;
            }
        }
    }
    let mark = |(index, mark): (usize, &Mark)| {
        let [shown, color] = [frame, plate].map(|picture| picture.pixels[index]);
        match found.likelier(color).filter(|_| is_near[index]) {
            Some(likelier) if likelier < 0.0 && *mark == Mark::BeforeToy => Mark::None,
            // The toy may be before a part of the thing.
            Some(likelier) if likelier > 0.0 && from_shaded(shown, color) < UNLIKE_CODES => Mark::BeforeToy,
            _ => *mark,
        }
    };
    marks.iter().enumerate().map(mark).collect()
}
