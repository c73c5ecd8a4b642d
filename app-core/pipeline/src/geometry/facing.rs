//! Which triangles face a place: of a closed shape no others hide anything from there.

use glam::{Vec3, Vec4, Vec4Swizzles};

/// Points that look at a shape: of a light, or the camera. All are points, or all are directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewers {
    /// A ball that holds them: its centre and radius.
    pub(super) centre: Vec3,
    pub(super) radius: f32,
    /// 1 of points, 0 of directions towards them.
    pub(super) w: f32,
}

impl Viewers {
    /// Of homogeneous points, `w` 1 or 0; none of none, and of both kinds at once.
    #[must_use]
    pub fn around(points: &[Vec4]) -> Option<Self> {
        let w = points.first()?.w;
        if points.iter().any(|point| point.w.to_bits() != w.to_bits()) {
            return None;
        }
        #[allow(clippy::cast_precision_loss, reason = "some dozens")]
        let centre = points.iter().map(|point| point.xyz()).sum::<Vec3>() / points.len() as f32;
        let radius = points
            .iter()
            .map(|point| point.xyz().distance(centre))
            .fold(0.0, f32::max);
        Some(Self { centre, radius, w })
    }

    /// Whether a triangle, counter-clockwise seen from outside, may show its outer side to one of them.
    fn may_see(&self, triangle: [Vec3; 3]) -> bool {
        self.sides_of(triangle)[0]
    }

    /// Whether a triangle may show its outer side to one of them, and whether its inner side.
    pub(super) fn sides_of(&self, [a, b, c]: [Vec3; 3]) -> [bool; 2] {
        let normal = (b - a).cross(c - a);
        let to_centre = self.centre - self.w * a;
        let towards = normal.dot(to_centre);
        // Of a ball the point that is farthest on either side; the rounding of a product of four is far below a thousandth.
        let reach = (self.radius + 1e-3 * to_centre.length()) * normal.length();
        [towards >= -reach, towards <= reach]
    }

    /// Corners of those triangles of a shape that face them, in the same order.
    #[must_use]
    pub fn facing(&self, positions: &[Vec3], corners: &[u32]) -> Vec<u32> {
        let triangles = corners.as_chunks::<3>().0.iter();
        let place = |corner: u32| positions.get(corner as usize).copied().unwrap_or_default();
        let facing = triangles.filter(|triangle| self.may_see(triangle.map(place)));
        facing.flatten().copied().collect()
    }
}
