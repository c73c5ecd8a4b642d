//! CPU reference of `validity.wgsl`: the content of the frame's pixels.

use glam::{IVec2, UVec2};

use super::raster::Raster;

/// Margin around the toy on a receiver, in pixels along each side: no pose is exact.
const EDGE_PX: i32 = 2;
/// The same for a pixel that determines its own plate: a compressed picture's colours bleed.
const BLEED_PX: i32 = 8;
/// Step between sampled pixels, over the larger distance.
const BLEED_STEP_PX: usize = 2;
/// Second difference of reversed depth, as a fraction of the central one, up to which a surface is
/// continuous.
const DEPTH_BEND: f64 = 0.002;

/// The marks of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// It is clear of the toy.
    pub is_clear: bool,
    /// It shows one surface of the toy.
    pub is_one_surface: bool,
    /// The picture's blur mixes another surface into it.
    pub is_mixed: bool,
    /// It is well clear of the toy.
    pub is_well_clear: bool,
}

/// Marks a texel by the reversed depth of the physical toy around it, which is 0 beside the toy and
/// repeated outside of the picture. The picture blurs the toy by `soft_px` pixels.
#[must_use]
pub fn mark(depth: &Raster<f64>, soft_px: i32, texel: UVec2) -> Marks {
    let last = depth.size().as_ivec2() - 1;
    let at = |offset: IVec2| depth.at((texel.as_ivec2() + offset).clamp(IVec2::ZERO, last).as_uvec2());
    let around = |reach_px: i32, step_px: usize| {
        let steps = move || (-reach_px..=reach_px).step_by(step_px).enumerate();
        steps().flat_map(move |row| steps().map(move |column| (column, row)))
    };
    let is_free = |x: i32, y: i32| at(IVec2::new(x, y)) == 0.0;
    let here = at(IVec2::ZERO);
    // A slope is linear in reversed depth, a step between two surfaces is not.
    let is_straight = |side: IVec2| {
        let (before, after) = (at(-side), at(side));
        before > 0.0 && after > 0.0 && (before + after - 2.0 * here).abs() <= DEPTH_BEND * here
    };
    let goes_on = |far_px: i32| {
        let sides = [IVec2::X, IVec2::Y, IVec2::ONE, IVec2::new(1, -1)];
        sides.into_iter().all(|side| is_straight(far_px * side))
    };
    let is_clear = around(EDGE_PX + soft_px, 1).all(|((_, x), (_, y))| is_free(x, y));
    // Like the dark squares of a chessboard.
    let mut bleeding =
        around(BLEED_PX, BLEED_STEP_PX).filter(|((column, _), (row, _))| (column + row) % 2 == 0);
    Marks {
        is_clear,
        is_one_surface: here > 0.0 && goes_on(1),
        is_mixed: soft_px > 0 && !(goes_on(soft_px) && goes_on((soft_px / 2).max(1))),
        is_well_clear: is_clear && bleeding.all(|((_, x), (_, y))| is_free(x, y)),
    }
}
