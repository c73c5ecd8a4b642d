//! Where a shape may be seen, or its shadow fall, or either be looked up from beside it; and whether all of the shadow is seen, so
//! that nothing of the shape needs to be cut off.

use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::{Projection, around, landings};
use crate::geometry::tiles::Tiles;

/// What rounding in 32 bits may add to a ball, as a share of its radius.
const ROUNDING: f32 = 1e-3;

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
    positions: &[Vec3],
    corners: &[u32],
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

/// A ball that holds a shape, in the space of a receiver.
#[derive(Clone, Copy, Debug)]
pub struct Caster {
    /// Its middle.
    pub centre: Vec3,
    /// In metres.
    pub radius_m: f32,
}

impl Caster {
    /// Whether a light point, (position, 1) or (unit direction, 0), is above all of it, and all of its shadow is farther than
    /// `near_m` before the camera. `depth` is that of the receiver's point (x, z, 1).
    ///
    /// Both are told by functions that are linear in a point of the shape: with its shadow s = (x, z, w), `flatten` of the
    /// shaders, these are w and depth . s - near w.
    #[must_use]
    pub fn has_whole_shadow(&self, light: Vec4, depth: Vec3, near_m: f32) -> bool {
        let beyond = depth - near_m * Vec3::Z;
        let rise = depth.x * light.x + depth.y * light.z + beyond.z * light.w;
        let before = Vec3::new(light.y * depth.x, -rise, light.y * depth.y);
        let above = Vec3::new(0.0, -light.w, 0.0);
        let least = |gradient: Vec3, at_origin: f32| {
            at_origin + gradient.dot(self.centre) - (1.0 + ROUNDING) * self.radius_m * gradient.length()
        };
        least(above, light.y) > 0.0 && least(before, beyond.z * light.y) > 0.0 && light.xyz().is_finite()
    }
}
