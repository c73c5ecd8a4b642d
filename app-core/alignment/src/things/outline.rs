//! Outlines of things before the toy in the pixels of the largest level: things are found in a level
//! of fewer pixels, and their outlines there are a pixel or two off.

use glam::IVec2;

use super::codes::{Codes, UNLIKE_CODES, from_shaded};
use super::found::Found;
use crate::picture::{index_in, places, square};
use app_scene::things::Mark;

/// Distance in pixels of the largest level from a marked outline within which the plate's colours
/// decide.
const WITHIN_PX: i32 = 3;

/// The marks with outlines of things before the toy where the plate's colours change. Frame and
/// plate are in codes.
pub(super) fn sharpened(found: &Found<'_>, [frame, plate]: [&Codes; 2], marks: &[Mark]) -> Vec<Mark> {
    let size_px = plate.size_px;
    let is_before = |at: IVec2| index_in(size_px, at).map(|index| marks[index] == Mark::BeforeToy);
    let mut near = vec![false; marks.len()];
    for at in places(size_px) {
        let ends = is_before(at) == Some(true) && square(at, 1).any(|at| is_before(at) == Some(false));
        if ends {
            for index in square(at, WITHIN_PX).filter_map(|at| index_in(size_px, at)) {
                near[index] = true;
            }
        }
    }
    let mark = |(index, mark): (usize, &Mark)| {
        if !near[index] {
            return *mark;
        }
        let [shown, color] = [frame, plate].map(|picture| picture.pixels[index]);
        match found.likelier(color) {
            Some(likelier) if likelier < 0.0 && *mark == Mark::BeforeToy => Mark::None,
            Some(likelier) if likelier > 0.0 && from_shaded(shown, color) < UNLIKE_CODES => Mark::BeforeToy,
            _ => *mark,
        }
    };
    marks.iter().enumerate().map(mark).collect()
}
