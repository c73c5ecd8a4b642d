//! Bounds of the pixels in which a shape or its shadow may be visible or may be looked up from a
//! neighbour, and whether the whole shadow is visible, so that no part of the shape needs clipping.

use glam::{UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::{Projection, around, landings};
use crate::geometry::tiles::Tiles;

/// Share of a ball's radius that rounding in 32 bits may add.
const ROUNDING: f32 = 1e-3;

/// The pixels of a target of `size_px` in which a shape may be visible, with a margin of one pixel
/// for rounding and the offsets of samples: all pixels if the shape's projection has no bounds,
/// none if it is outside the target.
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
    // The conversion to unsigned numbers cuts off the part before the target's origin.
    let [first, end] = [(low - 1.0).floor(), (high + 1.0).ceil()].map(|corner| corner.as_uvec2());
    let seen = PixelRect {
        origin_px: first,
        size_px: end.saturating_sub(first),
    };
    seen.common(&all)
}

/// Marks the tiles within `reach_px`, along either axis, of the places where a shape may be visible
/// or its shadow may fall: all tiles if these have no bounds. `corners` are those of its triangles.
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

/// A ball that contains a shape, in the space of a receiver.
#[derive(Clone, Copy, Debug)]
pub struct Caster {
    /// The ball's centre.
    pub centre: Vec3,
    /// The ball's radius in metres.
    pub radius_m: f32,
}

impl Caster {
    /// Whether a light point, (position, 1) or (unit direction, 0), is above the whole ball, and
    /// its whole shadow is farther than `near_m` in front of the camera. `depth` is that of the
    /// receiver's point (x, z, 1).
    ///
    /// Both conditions are functions that are linear in a point of the shape: with its shadow s =
    /// (x, z, w), `flatten` of the shaders, they are w and depth . s - near w.
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
