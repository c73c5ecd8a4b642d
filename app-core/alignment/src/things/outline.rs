//! Outlines of things before the toy, in pixels of the largest level: things are found in one of fewer
//! pixels, where they end a pixel too early or too late.

use glam::IVec2;

use super::codes::Codes;
use super::found::Found;
use super::groups::most_around;
use super::toy::Toy;
use crate::picture::{index_in, places, square};
use app_scene::things::Mark;

/// Distance from a marked outline within which the plate's colours decide, in pixels of the level in
/// which things were found: its own pixels, and half of one for colours that two share.
const WITHIN_PX: f64 = 1.5;

/// The marks with the outlines of things before the toy where the plate's colours change. Frame and
/// plate are in codes; `per_px` are pixels of the level with things for one of theirs.
pub(super) fn sharpened(
    (found, toy): (&Found<'_>, &Toy),
    [frame, plate]: [&Codes; 2],
    per_px: f64,
    marks: &[Mark],
) -> Vec<Mark> {
    let size_px = plate.size_px;
    #[allow(clippy::cast_possible_truncation, reason = "a few pixels")]
    let within_px = (WITHIN_PX / per_px).round() as i32;
    let is_before = |at| is_marked(marks, size_px, at);
    let mut is_near = vec![false; marks.len()];
    for at in places(size_px).filter(|at| is_before(*at) == Some(true)) {
        if square(at, 1).any(|at| is_before(at) == Some(false)) {
            for index in square(at, within_px).filter_map(|at| index_in(size_px, at)) {
                is_near[index] = true;
            }
        }
    }
    let mark = |((index, mark), at): ((usize, &Mark), IVec2)| {
        let color = plate.pixels[index];
        // What the frame alone shows ends elsewhere.
        let is_in_frame = || found.in_frame_at((at.as_dvec2() + 0.5) * per_px) != Mark::None;
        if !is_near[index] || is_in_frame() {
            return *mark;
        }
        if found.is_place_color(color) && *mark == Mark::BeforeToy {
            return Mark::None;
        }
        // The toy may be before a part of the thing.
        if found.is_own_color(color) && !toy.is_seen(at, [frame, plate]) {
            return Mark::BeforeToy;
        }
        *mark
    };
    let pixels = marks.iter().enumerate().zip(places(size_px));
    let sharp: Vec<Mark> = pixels.map(mark).collect();
    // A few pixels of the place have a thing's colours.
    let is_lone = |at: IVec2| !most_around(at, |at| is_marked(&sharp, size_px, at) == Some(true));
    let pixels = marks.iter().zip(&sharp).zip(places(size_px));
    let kept = pixels.map(|((before, now), at)| match now {
        Mark::BeforeToy if is_lone(at) => *before,
        _ => *now,
    });
    kept.collect()
}

/// Whether a pixel has the mark of a thing before the toy; `None` outside the picture.
fn is_marked(marks: &[Mark], size_px: IVec2, at: IVec2) -> Option<bool> {
    index_in(size_px, at).map(|index| marks[index] == Mark::BeforeToy)
}
