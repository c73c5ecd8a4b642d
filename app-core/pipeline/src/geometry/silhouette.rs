//! Selection of the triangles of a shape that face a set of viewpoints: in a closed shape no other
//! triangles hide anything. And bounds of its silhouettes from all of these viewpoints at once, so
//! that everything else is drawn only once.
//!
//! The area that a shape covers is bounded by its silhouette: edges between a triangle that shows
//! its outer side and one that shows its inner side, and edges of one triangle alone. A tile far
//! from every silhouette is the same from all viewpoints: fully covered or empty. Only triangles
//! that meet other tiles have to be drawn once per viewpoint. Source: Appel 1967 (silhouettes as
//! edges between front and back faces); tiles as in Green 2008 (bounds of penumbras).

use glam::{UVec2, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};

use crate::geometry::tiles::{PixelBox, Tiles};
use app_scene::geometry::edges::Edge;

/// Pixels along each side of a tile.
const TILE_PX: u32 = 4;
/// Largest distance of positions within a pixel from its centre, plus a margin for rounding in 32
/// bits.
pub const AROUND_PX: f32 = 0.55;

/// Viewpoints of a shape: those of a light, or the camera. All are points, or all are directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewers {
    /// Centre and radius of a ball that contains them.
    centre: Vec3,
    radius: f32,
    /// 1 for points, 0 for directions towards them.
    w: f32,
}

impl Viewers {
    /// The viewers at homogeneous points, `w` 1 or 0; `None` for an empty list or if both kinds
    /// occur.
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

    /// Whether a triangle, counter-clockwise from outside, may show its outer side to a viewer.
    fn may_see(&self, triangle: [Vec3; 3]) -> bool {
        self.sides_of(triangle)[0]
    }

    /// Whether a triangle may show its outer side to a viewer, and whether its inner side.
    fn sides_of(&self, [a, b, c]: [Vec3; 3]) -> [bool; 2] {
        let normal = (b - a).cross(c - a);
        let to_centre = self.centre - self.w * a;
        let towards = normal.dot(to_centre);
        // The point of the ball that is farthest on either side; the rounding of a product of four
        // is far below a thousandth.
        let reach = (self.radius + 1e-3 * to_centre.length()) * normal.length();
        [towards >= -reach, towards <= reach]
    }

    /// Corners of those triangles of a shape that face a viewer, in the same order.
    #[must_use]
    pub fn facing(&self, positions: &[Vec3], corners: &[u32]) -> Vec<u32> {
        let triangles = corners.as_chunks::<3>().0.iter();
        let place = |corner: u32| positions.get(corner as usize).copied().unwrap_or_default();
        let facing = triangles.filter(|triangle| self.may_see(triangle.map(place)));
        facing.flatten().copied().collect()
    }
}

/// The projection of a shape's points.
pub trait Projection {
    /// Image position of a point in anchor space; `None` if it has no bounds.
    fn land(&self, in_anchor: Vec3) -> Option<Landing>;

    /// Largest distance of a pixel's sample positions from its centre.
    fn around_px(&self) -> f32 {
        AROUND_PX
    }
}

/// Image position of a point, from one viewpoint or from many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Centre of the positions.
    pub at_px: Vec2,
    /// Largest distance from the centre along each axis.
    pub within_px: Vec2,
    /// Whether the point may be clipped: the silhouette then may also run there.
    pub may_be_cut: bool,
}

/// Projection to a camera, in front of receivers.
#[derive(Clone, Debug)]
pub struct ByCamera {
    /// Transform to clip space of the region.
    pub clip_from_anchor: glam::Mat4,
    /// Size of the region.
    pub region_size_px: Vec2,
    /// Corner of the target in the region.
    pub origin_px: Vec2,
    /// Inverse depths of the receivers' planes at a pixel of the region (u, v, 1).
    pub inverse_depths: Vec<Vec3>,
    /// Largest distance of a pixel's sample positions from its centre.
    pub around_px: f32,
}

/// Share of its depth by which a point may lie behind a receiver and still count as in front of it.
pub(crate) const ON_RECEIVER: f32 = 1e-4;

impl Projection for ByCamera {
    fn land(&self, in_anchor: Vec3) -> Option<Landing> {
        let clip = self.clip_from_anchor * in_anchor.extend(1.0);
        // Reversed depth: beyond 1 the point is nearer than the near plane.
        if clip.w <= 0.0 || clip.z > clip.w {
            return None;
        }
        let in_region_px = (clip.xy() / clip.w * Vec2::new(0.5, -0.5) + 0.5) * self.region_size_px;
        let inverse_depth = 1.0 / clip.w;
        // Half of the shaders' share, since depths are rounded.
        let is_behind =
            |plane: &Vec3| inverse_depth < plane.dot(in_region_px.extend(1.0)) * (1.0 - 0.5 * ON_RECEIVER);
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

/// Projection from the points of a light, as shadows on a receiver.
#[derive(Clone, Debug)]
pub struct OntoReceiver {
    /// Transform to the receiver's plane space, in which its plane is y = 0.
    pub plane_from_anchor: glam::Mat4,
    /// A ball that contains the light's points, in that space.
    pub light: Viewers,
    /// Homography: clip (x, y, w) of the plane's point (x, z, 1).
    pub clip_from_plane: glam::Mat3,
    /// Size of the region.
    pub region_size_px: Vec2,
    /// Depth in metres below which a shadow is clipped.
    pub near_m: f32,
    /// Largest distance of a pixel's sample positions from its centre.
    pub around_px: f32,
}

/// Height up to which a shadow may be clipped where its caster meets the receiver, in metres.
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
        // Bound of (aside / below) if both move by the radius.
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

/// A posed shape: its positions in anchor space, its triangles and their edges.
#[derive(Clone, Copy)]
pub struct Shape<'a> {
    /// Positions of all vertices, in anchor space.
    pub positions: &'a [Vec3],
    /// Three corners of each triangle.
    pub corners: &'a [u32],
    /// Edges between the triangles.
    pub edges: &'a [Edge],
}

/// The triangles that have to be drawn once per viewpoint, and the tiles in which they are needed.
#[derive(Clone, Debug)]
pub struct Silhouette {
    /// Tiles in which the viewpoints may see different things.
    pub tiles: Tiles,
    /// Corners of those requested triangles that meet these tiles.
    pub corners: Vec<u32>,
}

/// Finds the silhouette of a shape in a target of `size_px`. `facing` are the corners that are to
/// be drawn, at least those visible to a viewer. `None` if the image position of a point has no
/// bounds.
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
    // Whether a triangle may show its outer side, and whether its inner side.
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

/// Position of a corner that does not exist.
const NOWHERE: Landing = Landing {
    at_px: Vec2::ZERO,
    within_px: Vec2::ZERO,
    may_be_cut: false,
};

/// The image position of each corner of a shape; `None` if one has no bounds.
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

/// Whether a viewer may see the outer side of one triangle and the inner side of another.
fn may_part(sides: &[[bool; 2]], one: u32, other: u32) -> bool {
    let [[outer, inner], [other_outer, other_inner]] = [one, other].map(|index| sides[index as usize]);
    (outer && other_inner) || (inner && other_outer)
}

fn place(positions: &[Vec3], corner: u32) -> Vec3 {
    positions.get(corner as usize).copied().unwrap_or_default()
}

/// A box around all image positions of a triangle, grown by `reach_px`.
pub(super) fn around(landings: [Landing; 3], reach_px: f32) -> PixelBox {
    let low = landings.map(|one| one.at_px - one.within_px);
    let high = landings.map(|one| one.at_px + one.within_px);
    let reach = Vec2::splat(reach_px);
    [
        low[0].min(low[1]).min(low[2]) - reach,
        high[0].max(high[1]).max(high[2]) + reach,
    ]
}
