//! Where a shape may be seen, or looked up from beside it.

use glam::{Vec2, Vec3};

use crate::geometry::silhouette::{Projection, landings};
use crate::geometry::tiles::Tiles;

/// Marks the tiles within `reach_px`, along either axis, of what a camera may see of a shape: all of them where that has no
/// bounds. `corners` are those of its triangles.
pub fn mark_seen(
    tiles: &mut Tiles,
    (positions, corners): (&[Vec3], &[u32]),
    camera: &dyn Projection,
    reach_px: f32,
) {
    let Some(landings) = landings(positions, corners, camera) else {
        return tiles.mark_all();
    };
    let at_px = |corner: u32| landings.get(corner as usize).map(|landing| landing.at_px);
    for [a, b, c] in corners.as_chunks().0 {
        if let (Some(a), Some(b), Some(c)) = (at_px(*a), at_px(*b), at_px(*c)) {
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            tiles.mark_box([low - Vec2::splat(reach_px), high + Vec2::splat(reach_px)]);
        }
    }
}
