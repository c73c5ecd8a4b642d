//! Which triangles of a shape face points that look at it: of a closed shape no others hide anything from there. And where its
//! silhouette may run, seen from all of these points at once, so that all else is drawn but once.
//!
//! What a shape covers is bounded by its silhouette: edges between a triangle that shows its outer side and one that shows
//! its inner side, and edges of one triangle alone. In a tile that no silhouette of any point comes near, every point sees
//! the same: all of it is covered, or none. Only triangles that meet other tiles have to be drawn once for each point.
//! Source: Appel 1967 (silhouettes as edges between front and back faces); tiles as in Green 2008 (bounds of penumbras).

use glam::{UVec2, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};

use crate::geometry::tiles::{PixelBox, Tiles};
use app_scene::geometry::edges::Edge;

/// Pixels along each side of a tile.
const TILE_PX: u32 = 4;
/// Distance that positions within a pixel are from its centre, and some for the rounding of 32 bits.
pub const AROUND_PX: f32 = 0.55;

/// Points that look at a shape: of a light, or the camera. All are points, or all are directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewers {
    /// A ball that holds them: its centre and radius.
    centre: Vec3,
    radius: f32,
    /// 1 of points, 0 of directions towards them.
    w: f32,
}

impl Viewers {
    /// Of homogeneous points, `w` 1 or 0; none of none, and of both kinds at once.
    #[must_use]
    pub fn around(points: &[Vec4]) -> Option<Self> {
        let w = points.first()?.w;
        if points.iter().any(|point| point.w.to_bits() != w.to_bits()) {
            return None;
        }
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
    fn sides_of(&self, [a, b, c]: [Vec3; 3]) -> [bool; 2] {
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

/// Where points of a shape are seen.
pub trait Projection {
    /// Of a point in anchor space; none where that has no bounds.
    fn land(&self, in_anchor: Vec3) -> Option<Landing>;

    /// Farthest that the positions that a pixel is drawn for lie from its centre.
    fn around_px(&self) -> f32 {
        AROUND_PX
    }
}

/// Where a point is seen, from one point or from many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// In the middle.
    pub at_px: Vec2,
    /// How far from there, along each axis.
    pub within_px: Vec2,
    /// Whether something may cut off what is there: the silhouette then runs where it does.
    pub may_be_cut: bool,
}

/// From a camera, before receivers.
#[derive(Clone, Debug)]
pub struct ByCamera {
    /// Clip space of the region.
    pub clip_from_anchor: glam::Mat4,
    /// Size of the region.
    pub region_size_px: Vec2,
    /// Corner of the target in the region.
    pub origin_px: Vec2,
    /// Inverse depths of the receivers' planes at a pixel of the region (u, v, 1).
    pub inverse_depths: Vec<Vec3>,
    /// Farthest that the positions that a pixel is drawn for lie from its centre.
    pub around_px: f32,
}

/// Half of the share of its depth by which a point may lie behind a receiver and still be before it, as the shaders have it.
const ON_RECEIVER: f32 = 0.5e-4;

impl Projection for ByCamera {
    fn land(&self, in_anchor: Vec3) -> Option<Landing> {
        let clip = self.clip_from_anchor * in_anchor.extend(1.0);
        // Reversed depth: beyond 1 it is nearer than what is drawn.
        if clip.w <= 0.0 || clip.z > clip.w {
            return None;
        }
        let in_region_px = (clip.xy() / clip.w * Vec2::new(0.5, -0.5) + 0.5) * self.region_size_px;
        let inverse_depth = 1.0 / clip.w;
        let is_behind =
            |plane: &Vec3| inverse_depth < plane.dot(in_region_px.extend(1.0)) * (1.0 - ON_RECEIVER);
        Some(Landing {
            at_px: in_region_px - self.origin_px,
            within_px: Vec2::ZERO,
            may_be_cut: self.inverse_depths.iter().any(is_behind),
        })
    }

    fn around_px(&self) -> f32 {
        self.around_px
    }
}

/// From the points of a light, as shadows on a receiver.
#[derive(Clone, Debug)]
pub struct OntoReceiver {
    /// The receiver's plane is y = 0 there.
    pub plane_from_anchor: glam::Mat4,
    /// A ball that holds the light's points, in that space.
    pub light: Viewers,
    /// Homography: clip (x, y, w) of the plane's point (x, z, 1).
    pub clip_from_plane: glam::Mat3,
    /// Size of the region.
    pub region_size_px: Vec2,
    /// Depth in metres nearer than which a shadow is cut off.
    pub near_m: f32,
    /// Farthest that the positions that a pixel is drawn for lie from its centre.
    pub around_px: f32,
}

/// Height up to which a shadow may be cut off where its caster meets the receiver, in metres.
const NEAR_RECEIVER_M: f32 = 1e-5;

impl Projection for OntoReceiver {
    fn land(&self, in_anchor: Vec3) -> Option<Landing> {
        let in_plane = self.plane_from_anchor.transform_point3(in_anchor);
        let (height, light) = (in_plane.y, self.light.centre.extend(self.light.w));
        let below = light.y - light.w * height;
        let aside = light.w * in_plane.xz() - light.xz();
        let least_below = below - self.light.radius;
        if least_below <= 0.0 {
            return None;
        }
        let shadow = in_plane.xz() + aside * (height / below);
        // Of (aside / below), where either moves by the radius.
        let within_m = height.abs() * self.light.radius / least_below * (1.0 + aside.length() / below);
        let clip = self.clip_from_plane * shadow.extend(1.0);
        let rows = self.clip_from_plane.transpose();
        let [x, y, w] = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.truncate());
        let least_w = clip.z - within_m * w.length();
        if least_w <= self.near_m.max(0.0) {
            return None;
        }
        let at = clip.truncate() / clip.z;
        let moved = |row: Vec2, at: f32| within_m * (row - at * w).length() / least_w;
        let half = 0.5 * self.region_size_px;
        Some(Landing {
            at_px: (at * Vec2::new(0.5, -0.5) + 0.5) * self.region_size_px,
            within_px: Vec2::new(moved(x, at.x), moved(y, at.y)) * half,
            may_be_cut: height < NEAR_RECEIVER_M,
        })
    }

    fn around_px(&self) -> f32 {
        self.around_px
    }
}

/// A shape in a pose: its places in anchor space, its triangles, and their edges.
#[derive(Clone, Copy)]
pub struct Shape<'a> {
    /// Of all vertices, in anchor space.
    pub positions: &'a [Vec3],
    /// Three of each triangle.
    pub corners: &'a [u32],
    /// Between them.
    pub edges: &'a [Edge],
}

/// What has to be drawn once for each point, and where.
#[derive(Clone, Debug)]
pub struct Silhouette {
    /// Tiles in which the points may see different things.
    pub tiles: Tiles,
    /// Corners of the triangles, of those that were asked for, that meet these tiles.
    pub corners: Vec<u32>,
}

/// Looks for the silhouette of a shape in a target of `size_px`. `facing` are the corners that are to be drawn, at least those
/// that show to one of the viewers. None where what is seen of a point has no bounds.
#[must_use]
pub fn find_silhouette(
    shape: Shape<'_>,
    viewers: &Viewers,
    projection: &dyn Projection,
    facing: &[u32],
    size_px: UVec2,
) -> Option<Silhouette> {
    let landings = landings(shape.positions, shape.corners, projection)?;
    let land = |corner: u32| landings.get(corner as usize).copied().unwrap_or(NOWHERE);
    let triangles = shape.corners.as_chunks::<3>().0;
    // Whether a triangle may show its outer side, and its inner side.
    let sides: Vec<[bool; 2]> = triangles
        .iter()
        .map(|corners| viewers.sides_of(corners.map(|corner| place(shape.positions, corner))))
        .collect();
    let mut tiles = Tiles::over(size_px, TILE_PX);
    let around_px = projection.around_px();
    for edge in shape.edges {
        if edge
            .beside
            .is_none_or(|[one, other]| may_part(&sides, one, other))
        {
            let [from, to] = edge.ends.map(land);
            let reach_px = from.within_px.max(to.within_px) + around_px;
            tiles.mark_segment([from.at_px, to.at_px], reach_px);
        }
    }
    for corners in triangles {
        let landings = corners.map(land);
        if landings.iter().any(|landing| landing.may_be_cut) {
            tiles.mark_box(around(landings, around_px));
        }
    }
    let counted = tiles.counted();
    let corners: Vec<u32> = facing
        .as_chunks::<3>()
        .0
        .iter()
        .filter(|corners| counted.meets(around(corners.map(land), around_px)))
        .flatten()
        .copied()
        .collect();
    Some(Silhouette { tiles, corners })
}

/// Of a corner that there is not.
const NOWHERE: Landing = Landing {
    at_px: Vec2::ZERO,
    within_px: Vec2::ZERO,
    may_be_cut: false,
};

/// Where each corner of a shape is seen; none where one has no bounds.
pub(super) fn landings(
    positions: &[Vec3],
    corners: &[u32],
    projection: &dyn Projection,
) -> Option<Vec<Landing>> {
    let mut is_used = vec![false; positions.len()];
    for corner in corners {
        if let Some(is_used) = is_used.get_mut(*corner as usize) {
            *is_used = true;
        }
    }
    let land = |(position, is_used): (&Vec3, bool)| match is_used {
        true => projection.land(*position),
        false => Some(NOWHERE),
    };
    positions.iter().zip(is_used).map(land).collect()
}

/// Whether one of the viewers may see the outer side of one triangle and the inner side of another.
fn may_part(sides: &[[bool; 2]], one: u32, other: u32) -> bool {
    let [[outer, inner], [other_outer, other_inner]] = [one, other].map(|index| sides[index as usize]);
    (outer && other_inner) || (inner && other_outer)
}

fn place(positions: &[Vec3], corner: u32) -> Vec3 {
    positions.get(corner as usize).copied().unwrap_or_default()
}

/// A box around all that is seen of a triangle, and `reach_px` beyond.
pub(super) fn around(landings: [Landing; 3], reach_px: f32) -> PixelBox {
    let low = landings.map(|one| one.at_px - one.within_px);
    let high = landings.map(|one| one.at_px + one.within_px);
    let reach = Vec2::splat(reach_px);
    [
        low[0].min(low[1]).min(low[2]) - reach,
        high[0].max(high[1]).max(high[2]) + reach,
    ]
}
