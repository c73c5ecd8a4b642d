//! Where a shape may be seen, or its shadow fall, or either be looked up from beside it.

use glam::{UVec2, Vec2, Vec3};

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::{Projection, around, landings};
use crate::geometry::tiles::Tiles;

/// The pixels of a target of `size_px` in which a shape may be seen, with one around for what rounding and the offsets of samples
/// add: all of them where that has no bounds, none where it is beyond the target.
#[must_use]
pub fn seen_rect(positions: &[Vec3], projection: &dyn Projection, size_px: UVec2) -> Option<PixelRect> {
    let all = PixelRect {
        origin_px: UVec2::ZERO,
        size_px,
    };
    let nothing = [Vec2::INFINITY, Vec2::NEG_INFINITY];
    let seen = positions.iter().try_fold(nothing, |[low, high], position| {
        let landing = projection.land(*position)?;
        let (at, within) = (landing.at_px, landing.within_px);
        Some([low.min(at - within), high.max(at + within)])
    });
    let Some([low, high]) = seen else {
        return Some(all);
    };
    // What lies before the target's origin is cut off by the numbers without a sign.
    let [first, end] = [(low - 1.0).floor(), (high + 1.0).ceil()].map(|corner| corner.as_uvec2());
    let seen = PixelRect {
        origin_px: first,
        size_px: end.saturating_sub(first),
    };
    seen.common(&all)
}

/// Marks the tiles within `reach_px`, along either axis, of where a shape may be seen, or its shadow fall: all of them where that
/// has no bounds. `corners` are those of its triangles.
pub fn mark_seen(
    tiles: &mut Tiles,
    (positions, corners): (&[Vec3], &[u32]),
    projection: &dyn Projection,
    reach_px: f32,
) {
    if corners.is_empty() {
        return;
    }
    let Some(landings) = landings(positions, corners, projection) else {
        return tiles.mark_all();
    };
    let land = |corner: u32| landings.get(corner as usize).copied();
    for [a, b, c] in corners.as_chunks().0 {
        if let (Some(a), Some(b), Some(c)) = (land(*a), land(*b), land(*c)) {
            tiles.mark_box(around([a, b, c], reach_px));
        }
    }
}
