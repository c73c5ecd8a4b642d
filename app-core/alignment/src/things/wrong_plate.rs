//! The wrong part of a plate.

use glam::IVec2;

use super::codes::Codes;
use super::colors::Colors;
use super::groups::{groups, in_level, place_of};
use super::grown::{Grown, TOUCH_PX, like_place};
use super::toy::Toy;
use crate::lights::Compared;
use crate::picture::{Mask, places, square};

/// Least difference between plate and model around a wrong part of the plate, in plates.
const DIFFERS: f32 = 0.05;
/// The same as a multiple of the noise.
const OF_NOISE: f32 = 2.0;
/// Margin of such a part that is wrong, too, in pixels.
const WRONG_PX: i32 = 2;
/// Minimum number of pixels of a shadow in the plate that touches what casts it.
const LEAST_SHADOW: usize = 30;

/// Wrong part of a level's plate: everything that is connected with seeds and differs from the
/// model; behind the toy, the area that it grew to, without what has the place's colours in the plate;
/// and the shadow of all this in the plate, which has the place's own colours.
///
/// The colours are learned from all that is seen to be wrong or right, also away from the toy's shadow:
/// a blockman on tiles had 7614 of his pixels marked, of which 2059 hide the toy in the plate, and has
/// 2548 now; a heron on gingham 2747, of which 772 do, and 1096.
pub(super) fn wrong_plate(grown: &Grown, toy: &Toy, plate: &Codes, compared: &[Compared]) -> Mask {
    let size_px = plate.size_px;
    let differs = in_level(size_px, compared, None, |pixel| {
        Some(pixel.is_away(DIFFERS, OF_NOISE))
    });
    let is_behind = |at: IVec2| toy.coverage.is_near(at, WRONG_PX);
    let has_grown = |at: IVec2| grown.of_pixel(at).is_some();
    let mut seen = [Vec::new(), Vec::new()];
    for ((at, differs), color) in places(size_px).zip(&differs).zip(&plate.pixels) {
        match differs.filter(|_| !is_behind(at)) {
            Some(true) if has_grown(at) => seen[0].push(*color),
            Some(false) => seen[1].push(*color),
            _ => {}
        }
    }
    let [wrong, right] = seen;
    let colors = Colors::of(wrong.into_iter(), right.into_iter());
    let is_like_place = like_place(size_px, plate, &colors);
    let mut wrong = Mask::new(size_px);
    for ((at, differs), is_like_place) in places(size_px).zip(differs).zip(is_like_place) {
        let is_wrong = differs == Some(true) || (is_behind(at) && !is_like_place);
        if has_grown(at) && is_wrong {
            wrong.mark(at);
        }
    }
    mark_shadows(&mut wrong, size_px, compared);
    filled(&wrong.grown(WRONG_PX), size_px)
}

/// Marks the shadows in the plate that touch a wrong part: groups of pixels with less light than the frame
/// would leave them.
fn mark_shadows(wrong: &mut Mask, size_px: IVec2, compared: &[Compared]) {
    let is_darker = in_level(size_px, compared, false, |pixel| {
        let lighter = [0, 1, 2].map(|channel| pixel.ratio[channel] - pixel.model[channel]);
        let is_lighter = |channel: usize| lighter[channel] > -DIFFERS.max(OF_NOISE * pixel.noises[channel]);
        pixel.is_away(DIFFERS, OF_NOISE) && (0..3).all(is_lighter)
    });
    let touches = |index: &usize| square(place_of(*index, size_px), TOUCH_PX).any(|at| wrong.has(at));
    let shadows: Vec<Vec<usize>> = groups(size_px, |index| is_darker[index])
        .into_iter()
        .filter(|group| group.len() >= LEAST_SHADOW && group.iter().any(touches))
        .collect();
    for index in shadows.into_iter().flatten() {
        wrong.mark(place_of(index, size_px));
    }
}

/// The mask, with its holes filled.
fn filled(mask: &Mask, size_px: IVec2) -> Mask {
    let has = |index: usize| mask.has(place_of(index, size_px));
    let last = size_px - 1;
    let is_at_border = |at: IVec2| at.cmpeq(IVec2::ZERO).any() || at.cmpeq(last).any();
    let mut filled = mask.clone();
    for group in groups(size_px, |index| !has(index)) {
        if !group.iter().any(|index| is_at_border(place_of(*index, size_px))) {
            group
                .iter()
                .for_each(|index| filled.mark(place_of(*index, size_px)));
        }
    }
    filled
}
