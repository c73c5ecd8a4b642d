//! Convex shapes: their exact intersections with rays, and their meshes in a toy's file.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

/// Facets of a sphere's mesh around its equator; half as many from pole to pole.
const N_SPHERE_FACETS: u32 = 48;

/// All points with `normal` · p at most `offset_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Unit vector out of the half-space.
    pub normal: DVec3,
    /// Distance of its plane from the origin along `normal`.
    pub offset_m: f64,
}

/// A convex shape around the origin of its part's space.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Its radius.
        radius_m: f64,
    },
    /// The intersection of half-spaces, which must be bounded.
    Convex(Vec<HalfSpace>),
}

/// The part of a ray inside of a shape, in multiples of the ray's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Entry; negative if it is behind the ray's origin.
    pub enter: f64,
    /// Exit.
    pub leave: f64,
    /// Unit normal at the entry.
    pub normal: DVec3,
}

/// Triangles, counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub positions: Vec<DVec3>,
    /// One unit normal per corner.
    pub normals: Vec<DVec3>,
    /// Three corners per triangle.
    pub indices: Vec<u32>,
}

impl Shape {
    /// A box with faces at right angles to the axes.
    #[must_use]
    pub fn cuboid(half_m: DVec3) -> Self {
        let sides = [(DVec3::X, half_m.x), (DVec3::Y, half_m.y), (DVec3::Z, half_m.z)];
        let pairs = sides
            .into_iter()
            .flat_map(|(normal, offset_m)| [normal, -normal].map(|normal| HalfSpace { normal, offset_m }));
        Self::Convex(pairs.collect())
    }

    /// An upright prism over a convex outline (x, z), counter-clockwise as drawn with x to the right and z up.
    #[must_use]
    pub fn prism(outline_m: &[DVec2], half_height_m: f64) -> Self {
        let next = outline_m.iter().cycle().skip(1);
        let sides = outline_m.iter().zip(next).map(|(from, to)| {
            let along = (*to - *from).normalize();
            let normal = DVec3::new(along.y, 0.0, -along.x);
            HalfSpace {
                normal,
                offset_m: normal.dot(DVec3::new(from.x, 0.0, from.y)),
            }
        });
        let ends = [DVec3::Y, -DVec3::Y].map(|normal| HalfSpace {
            normal,
            offset_m: half_height_m,
        });
        Self::Convex(sides.chain(ends).collect())
    }

    /// The part of the ray's whole line that is inside, or `None` if it misses.
    #[must_use]
    pub fn crossing(&self, origin: DVec3, direction: DVec3) -> Option<Crossing> {
        match self {
            Self::Sphere { radius_m } => cross_sphere(*radius_m, origin, direction),
            Self::Convex(half_spaces) => cross_convex(half_spaces, origin, direction),
        }
    }

    /// Radius of a ball around the origin that holds the shape.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        match self {
            Self::Sphere { radius_m } => *radius_m,
            Self::Convex(_) => {
                let corners = self.mesh().positions;
                corners.iter().map(|corner| corner.length()).fold(0.0, f64::max)
            }
        }
    }

    /// The shape as triangles: exact for a convex one, with many facets for a sphere.
    #[must_use]
    pub fn mesh(&self) -> Mesh {
        match self {
            Self::Sphere { radius_m } => sphere_mesh(*radius_m),
            Self::Convex(half_spaces) => convex_mesh(half_spaces),
        }
    }

    /// The shape in a mirror that swaps the sign of x.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        match self {
            Self::Sphere { .. } => self.clone(),
            Self::Convex(half_spaces) => Self::Convex(
                half_spaces
                    .iter()
                    .map(|half_space| HalfSpace {
                        normal: half_space.normal * DVec3::new(-1.0, 1.0, 1.0),
                        ..*half_space
                    })
                    .collect(),
            ),
        }
    }
}

fn cross_sphere(radius_m: f64, origin: DVec3, direction: DVec3) -> Option<Crossing> {
    let squared_length = direction.length_squared();
    let middle = -origin.dot(direction) / squared_length;
    // From the point nearest to the centre, so that nothing cancels for a distant ray.
    let squared_half = radius_m * radius_m - (origin + middle * direction).length_squared();
    if squared_half <= 0.0 {
        return None;
    }
    let half = (squared_half / squared_length).sqrt();
    Some(Crossing {
        enter: middle - half,
        leave: middle + half,
        normal: (origin + (middle - half) * direction) / radius_m,
    })
}

fn cross_convex(half_spaces: &[HalfSpace], origin: DVec3, direction: DVec3) -> Option<Crossing> {
    let mut inside = Crossing {
        enter: f64::NEG_INFINITY,
        leave: f64::INFINITY,
        normal: DVec3::ZERO,
    };
    for half_space in half_spaces {
        let height = half_space.offset_m - half_space.normal.dot(origin);
        let speed = half_space.normal.dot(direction);
        if speed == 0.0 {
            if height < 0.0 {
                return None;
            }
            continue;
        }
        let at = height / speed;
        if speed > 0.0 {
            inside.leave = inside.leave.min(at);
        } else if at > inside.enter {
            inside.enter = at;
            inside.normal = half_space.normal;
        }
    }
    (inside.enter < inside.leave).then_some(inside)
}

/// Each face is a square on its plane, far larger than the shape, clipped by all other half-spaces.
///
/// Source: Sutherland and Hodgman 1974.
fn convex_mesh(half_spaces: &[HalfSpace]) -> Mesh {
    let farthest = half_spaces.iter().map(|half| half.offset_m.abs());
    let reach_m = 1e3 * farthest.fold(0.0, f64::max);
    let mut mesh = Mesh::default();
    for (index, face) in half_spaces.iter().enumerate() {
        let (across, along) = face.normal.any_orthonormal_pair();
        let middle = face.offset_m * face.normal;
        let corner = |s: f64, t: f64| middle + reach_m * (s * across + t * along);
        let mut polygon = vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        let others = half_spaces.iter().enumerate();
        for (_, other) in others.filter(|(other, _)| *other != index) {
            polygon = cut(&polygon, other);
        }
        if across.cross(along).dot(face.normal) < 0.0 {
            polygon.reverse();
        }
        mesh.add_fan(&polygon, face.normal);
    }
    mesh
}

fn cut(polygon: &[DVec3], half_space: &HalfSpace) -> Vec<DVec3> {
    let height = |point: DVec3| half_space.normal.dot(point) - half_space.offset_m;
    let mut kept = Vec::new();
    let next = polygon.iter().cycle().skip(1);
    for (from, to) in polygon.iter().zip(next) {
        let (start, end) = (height(*from), height(*to));
        if start <= 0.0 {
            kept.push(*from);
        }
        if (start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0) {
            kept.push(from.lerp(*to, start / (start - end)));
        }
    }
    kept
}

fn sphere_mesh(radius_m: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let n_rows = N_SPHERE_FACETS / 2;
    for row in 0..=n_rows {
        let polar_rad = PI * f64::from(row) / f64::from(n_rows);
        for column in 0..=N_SPHERE_FACETS {
            let (sin, cos) = (TAU * f64::from(column) / f64::from(N_SPHERE_FACETS)).sin_cos();
            let normal = DVec3::new(polar_rad.sin() * cos, polar_rad.cos(), polar_rad.sin() * sin);
            mesh.positions.push(radius_m * normal);
            mesh.normals.push(normal);
        }
    }
    let stride = N_SPHERE_FACETS + 1;
    for (row, column) in (0..n_rows).flat_map(|row| (0..N_SPHERE_FACETS).map(move |column| (row, column))) {
        let at = row * stride + column;
        let quad = [at, at + 1, at + stride + 1, at, at + stride + 1, at + stride];
        // At a pole one of the two has no area.
        let halves = quad.chunks_exact(3).enumerate();
        for (half, triangle) in halves {
            let is_flat = (row == 0 && half == 0) || (row + 1 == n_rows && half == 1);
            if !is_flat {
                mesh.indices.extend(triangle);
            }
        }
    }
    mesh
}

impl Mesh {
    fn add_fan(&mut self, polygon: &[DVec3], normal: DVec3) {
        #[allow(clippy::cast_possible_truncation, reason = "a face has a handful of corners")]
        let (first, n_corners) = (self.positions.len() as u32, polygon.len() as u32);
        self.positions.extend(polygon);
        self.normals.extend(polygon.iter().map(|_| normal));
        for corner in 2..n_corners {
            self.indices.extend([first, first + corner - 1, first + corner]);
        }
    }
}
