//! Where a shape may be seen, or its shadow fall, or either be looked up from beside it.

use glam::Vec3;

use crate::geometry::silhouette::{Projection, around, landings};
use crate::geometry::tiles::Tiles;

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
