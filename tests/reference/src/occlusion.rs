//! CPU reference of `occlusion.wgsl`: the light points that a posed mesh hides from a point of the
//! receiver.
//!
//! The shader projects the mesh onto the receiver; here a ray goes from the receiver to the light.

use glam::{DVec2, DVec3, DVec4, UVec2};

use super::model::{ReceiverPoint, Region};
use super::real::{Real, Vector};

/// Sample position of light point `i` of `n_points` within a pixel, from its top left corner, in
/// pixels: a lattice of equal numbers of rows and columns.
#[must_use]
pub fn sample_position(i: usize, n_points: usize) -> DVec2 {
    let [column, row] = [47, 53].map(|step| (i * step % n_points) as f64);
    (DVec2::new(column, row) + 0.5) / n_points as f64
}

/// The spread of a point in a blurred picture, the pixel's own included.
#[derive(Clone, Copy, Debug)]
pub struct PointSpread {
    /// Its principal axes, as long as its standard deviations.
    pub axes_px: [DVec2; 2],
    /// Whether it is uniform along the first, and not normal.
    pub is_line: bool,
}

/// The same in a blurred picture: the lattice's rows and columns become quantiles of the spread.
#[must_use]
pub fn spread_position(lattice: DVec2, spread: PointSpread) -> DVec2 {
    let [first, second] = spread.axes_px;
    let along = if spread.is_line {
        // A uniform distribution from -1 to 1 has a deviation of the root of a third.
        (2.0 * lattice.x - 1.0) / (1.0_f64 / 3.0).sqrt()
    } else {
        normal_quantile(lattice.x)
    };
    0.5 + along * first + normal_quantile(lattice.y) * second
}

/// Quantile of the normal distribution. Source: Winitzki 2008, whose one constant is .147.
#[must_use]
pub fn normal_quantile(part: f64) -> f64 {
    const A: f64 = 0.147;
    let x = 2.0 * part - 1.0;
    let log = (1.0 - x * x).ln();
    let half = 2.0 / (std::f64::consts::PI * A) + log / 2.0;
    let inverse_error = ((half * half - log / A).sqrt() - half).sqrt();
    std::f64::consts::SQRT_2 * inverse_error * x.signum()
}

type Triangle<R> = [Vector<R>; 3];

/// A posed mesh in plane space, with the precision of its ray intersections.
#[derive(Clone, Debug)]
pub struct Occluder<R = f64> {
    triangles: Vec<Triangle<R>>,
    tree: Tree<R>,
}

/// The intersection of a ray and a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in multiples of the ray's direction.
    pub distance: f64,
    /// The triangle, in the order of the mesh.
    pub triangle: usize,
}

impl<R: Real> Occluder<R> {
    /// A mesh of triangles; each three indices are the corners of one.
    #[must_use]
    pub fn new(positions: &[DVec3], indices: &[u32]) -> Self {
        let triangles = indices
            .chunks_exact(3)
            .map(|corners| [0, 1, 2].map(|k| positions[corners[k] as usize].into()));
        let triangles: Vec<Triangle<R>> = triangles.collect();
        Self {
            tree: Tree::new(triangles.clone()),
            triangles,
        }
    }

    /// Whether the mesh stands between the receiver point (x, z) and a homogeneous light point.
    #[must_use]
    pub fn hides(&self, in_plane: DVec2, light_point: DVec4) -> bool {
        self.stands_between(DVec3::new(in_plane.x, 0.0, in_plane.y), light_point)
    }

    /// Whether the mesh stands between a point and a homogeneous light point.
    #[must_use]
    pub fn stands_between(&self, origin: DVec3, light_point: DVec4) -> bool {
        let (origin, light) = (Vector::from(origin), Vector::from(light_point.truncate()));
        let (direction, end) = if light_point.w == 0.0 {
            (light, R::from_f64(f64::INFINITY))
        } else {
            (light - origin, R::ONE)
        };
        self.tree.stops(origin, direction, end)
    }

    /// The nearest triangle that a ray meets.
    #[must_use]
    pub fn nearest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let (origin, direction) = (Vector::from(origin), Vector::from(direction));
        if !self
            .tree
            .reaches_box(origin, direction, R::from_f64(f64::INFINITY))
        {
            return None;
        }
        let hits = self
            .triangles
            .iter()
            .enumerate()
            .filter_map(|(triangle, corners)| {
                let distance = meets(origin, direction, corners)?.to_f64();
                Some(Hit { distance, triangle })
            });
        hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

/// A mesh with its light samples, in a receiver's plane space: points of a light, or directions of
/// the ambient light.
#[derive(Clone, Debug)]
pub struct Caster<R = f64> {
    /// The posed mesh.
    pub occluder: Occluder<R>,
    /// Homogeneous: (position, 1) or (direction, 0).
    pub light_points: Vec<DVec4>,
}

/// Share of the light points, each sampled at its position, that the mesh hides from `texel` of a
/// map of `map_px` texels over the region, or `None` if that texel shows no receiver. There is a
/// caster for each receiver.
///
/// Light point i is sampled at [`sample_position`]. Of several receivers a texel shows the one at
/// its centre; a single one counts as infinite.
#[must_use]
pub fn hidden_share<R: Real>(
    casters: &[Caster<R>],
    region: &Region,
    (map_px, texel): (UVec2, UVec2),
) -> Option<f64> {
    let position = |i, n_points| sample_position(i, n_points);
    hidden_share_from(casters, region, (map_px, texel), position)
}

/// The same with a separate position for each light point, in texels from the top left corner of
/// the texel.
#[must_use]
pub fn hidden_share_from<R: Real>(
    casters: &[Caster<R>],
    region: &Region,
    (map_px, texel): (UVec2, UVec2),
    place: impl Fn(usize, usize) -> DVec2,
) -> Option<f64> {
    let region_px_per_texel = region.size_px.as_dvec2() / map_px.as_dvec2();
    let receiver = if casters.len() == 1 {
        0
    } else {
        let centre = (texel.as_dvec2() + 0.5) * region_px_per_texel;
        region.receiver_point(centre)?.receiver
    };
    let (caster, plane) = (&casters[receiver], &region.receivers[receiver]);
    let mut n_hidden = 0.0;
    for (i, light_point) in caster.light_points.iter().enumerate() {
        let position = texel.as_dvec2() + place(i, caster.light_points.len());
        let in_plane = plane.plane_point(position * region_px_per_texel)?;
        // A point behind the receiver does not illuminate it.
        let is_hidden = light_point.y > 0.0 && caster.occluder.hides(in_plane, *light_point);
        n_hidden += f64::from(u8::from(is_hidden));
    }
    let n_points = caster.light_points.len() as f64;
    Some(n_hidden / n_points)
}

/// Part of the light from a place of a receiver that all lights together give it.
const LIT_PART: f64 = 0.8;
/// Cosine between a receiver and the first one below which it is upright.
const UPRIGHT: f64 = 0.5;

/// The part of a direction's light that the toy's shadows take from an upright receiver's point,
/// which sees a place of another receiver there; 0 if it sees none, or one that is hidden from the
/// camera. `direction` is in the receiver's space. `hidden` is the part of a light that the toy
/// hides from that place, whose position in the region is given, too.
#[must_use]
pub fn taken_from(
    region: &Region,
    from: ReceiverPoint,
    direction: DVec3,
    hidden: impl Fn(usize, ReceiverPoint, DVec2) -> f64,
) -> f64 {
    let Some(place) = seen_place(region, from, direction) else {
        return 0.0;
    };
    let plane = region.plane_of(place);
    let at_px = plane.region_px(place.in_plane);
    let Some(at_px) = at_px.filter(|at| at.min_element() >= 0.0 && at.cmplt(region.size_px.as_dvec2()).all())
    else {
        return 0.0;
    };
    let seen = region.receiver_point(at_px.floor() + 0.5);
    if seen.is_none_or(|seen| seen.receiver != place.receiver) {
        return 0.0;
    }
    let above: Vec<usize> = (0..plane.lights.len())
        .filter(|i| plane.lights[*i].y > 0.0)
        .collect();
    let taken = above
        .iter()
        .map(|i| hidden(*i, place, at_px) * region.falloff(*i, place));
    LIT_PART * taken.sum::<f64>() / above.len().max(1) as f64
}

/// The nearest place of a receiver that an upright one sees in a direction of its space.
fn seen_place(region: &Region, from: ReceiverPoint, direction: DVec3) -> Option<ReceiverPoint> {
    let own = &region.receivers[from.receiver];
    if own.plane_from_anchor.y_axis.y >= UPRIGHT {
        return None;
    }
    let places = region
        .receivers
        .iter()
        .enumerate()
        .filter_map(|(receiver, plane)| {
            let plane_from_own = plane.plane_from_anchor * own.plane_from_anchor.inverse();
            let at = plane_from_own.transform_point3(DVec3::new(from.in_plane.x, 0.0, from.in_plane.y));
            let along = plane_from_own.transform_vector3(direction);
            let distance = at.y / -along.y;
            let met = at + distance * along;
            let in_plane = DVec2::new(met.x, met.z);
            let is_met =
                receiver != from.receiver && at.y > 0.0 && along.y < 0.0 && plane.rect.holds(in_plane);
            is_met.then_some((distance, ReceiverPoint { receiver, in_plane }))
        });
    let nearest = places.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, place)| place)
}

/// A bounding volume hierarchy of triangles.
#[derive(Clone, Debug)]
struct Tree<R> {
    min: Vector<R>,
    max: Vector<R>,
    branch: Branch<R>,
}

#[derive(Clone, Debug)]
enum Branch<R> {
    Leaf(Vec<Triangle<R>>),
    Fork(Box<[Tree<R>; 2]>),
}

impl<R: Real> Tree<R> {
    const MAX_LEAF: usize = 4;

    fn new(mut triangles: Vec<Triangle<R>>) -> Self {
        let corners = triangles.as_flattened();
        let [far, near] = [f64::INFINITY, f64::NEG_INFINITY].map(|far| Vector::splat(R::from_f64(far)));
        let min = corners.iter().copied().fold(far, Vector::min);
        let max = corners.iter().copied().fold(near, Vector::max);
        let branch = if triangles.len() <= Self::MAX_LEAF {
            Branch::Leaf(triangles)
        } else {
            let axis = DVec3::from(max - min).max_position();
            let middle = |corners: &Triangle<R>| -> R { corners.iter().map(|corner| corner[axis]).sum() };
            triangles.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
            let upper = triangles.split_off(triangles.len() / 2);
            Branch::Fork(Box::new([Self::new(triangles), Self::new(upper)]))
        };
        Self { min, max, branch }
    }

    /// Whether a ray meets a triangle before `end`.
    fn stops(&self, origin: Vector<R>, direction: Vector<R>, end: R) -> bool {
        self.reaches_box(origin, direction, end)
            && match &self.branch {
                Branch::Leaf(triangles) => triangles
                    .iter()
                    .any(|corners| meets(origin, direction, corners).is_some_and(|t| t < end)),
                Branch::Fork(halves) => halves.iter().any(|half| half.stops(origin, direction, end)),
            }
    }

    /// Slab test against the bounding box: most rays miss it.
    fn reaches_box(&self, origin: Vector<R>, direction: Vector<R>, end: R) -> bool {
        let to_min = (self.min - origin) / direction;
        let to_max = (self.max - origin) / direction;
        let enter = to_min.min(to_max).max_element();
        let leave = to_min.max(to_max).min_element();
        // A ray within a face gives 0 / 0, for which no comparison holds: it must be tested against
        // the triangles.
        let is_past = enter.max(R::ZERO) > leave.min(end);
        !is_past
    }
}

/// Distance, in multiples of `direction`, at which a ray meets a triangle, from either side.
///
/// Source: Moller and Trumbore 1997.
fn meets<R: Real>(origin: Vector<R>, direction: Vector<R>, corners: &Triangle<R>) -> Option<R> {
    let [a, b, c] = *corners;
    let (ab, ac, from_a) = (b - a, c - a, origin - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == R::ZERO {
        return None;
    }
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(ab);
    let v = direction.dot(q) / determinant;
    let t = ac.dot(q) / determinant;
    (u >= R::ZERO && v >= R::ZERO && u + v <= R::ONE && t >= R::ZERO).then_some(t)
}
