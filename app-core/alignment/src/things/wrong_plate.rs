//! The wrong part of a plate.

use glam::IVec2;

use super::groups::{groups, in_level, place_of};
use super::grown::Grown;
use super::toy::Toy;
use crate::lights::Compared;
use crate::picture::{Mask, index_in, places};

/// Difference between plate and model around a wrong part of the plate, in plates, and the margin
/// in pixels that is wrong, too.
const DIFFERS: f32 = 0.05;
const WRONG_PX: i32 = 2;

/// Wrong part of a level's plate: everything that is connected with seeds and differs from the
/// model; behind the toy, the area that it grew to.
pub(super) fn wrong_plate(grown: &Grown, toy: &Toy, size_px: IVec2, compared: &[Compared]) -> Mask {
    let differs = in_level(size_px, compared, false, |pixel| {
        pixel.away() > DIFFERS.max(2.0 * pixel.noise)
    });
    let mut wrong = Mask::new(size_px);
    for at in places(size_px) {
        let near_toy = toy.coverage.is_near(at, WRONG_PX);
        let differs = index_in(size_px, at).is_some_and(|index| differs[index]);
        if grown.of_pixel(at).is_some() && (near_toy || differs) {
            wrong.mark(at);
        }
    }
    filled(&wrong.grown(WRONG_PX), size_px)
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
