//! Mesh simplification on the same vertices: edges are collapsed onto one of their ends, in the
//! order of the resulting error.
//!
//! A removed vertex is moved onto a neighbour: so the remaining ones keep their joints, weights and
//! targets, and the simplified shape follows every pose. Faces of closed pieces stay closed: an
//! edge and its opposite collapse together.
//!
//! Source: quadrics of Garland and Heckbert 1997, with their planes along borders. Instead of one
//! shape there are several, one per pose, and the cost of a collapse is its largest cost over them
//! (DeCoro and Rusinkiewicz 2005 use the sum). The link condition is that of Dey et al. 1999.
//! Collapses are ordered by error, and by indices for equal errors.

mod links;
mod quadric;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use links::Links;
use quadric::Quadric;

/// A vertex that is moved onto another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Collapse {
    pub(super) from: u32,
    pub(super) to: u32,
    /// Distance of the shape after this and all earlier collapses from the first one, in units of
    /// the positions.
    pub(super) error: f64,
    /// Number of remaining triangles.
    pub(super) n_left: usize,
}

/// Collapses that rotate a triangle by more than this angle's cosine are refused.
const LEAST_COSINE: f64 = 0.25;
/// The root mean squared distance of planes from a vertex is at least this fraction of the largest
/// distance between the surfaces: .45 to 1.1 on a torus and on a jointed toy.
const MEAN_OF_LARGEST: f64 = 0.33;

/// Collapses edges, one after the other, until an error or a number of triangles is reached.
/// `poses` are the positions of all vertices in some poses, at least one.
pub(super) fn collapses(
    triangles: &[[u32; 3]],
    poses: &[Vec<Vec3>],
    (most_error, least_triangles): (f64, usize),
) -> Vec<Collapse> {
    let mut state = State::new(triangles, poses);
    let mut made: Vec<Collapse> = Vec::new();
    while state.links.n_triangles() > least_triangles {
        let Some(candidate) = state.next() else {
            break;
        };
        if candidate.error > most_error {
            break;
        }
        let [from, to] = candidate.edge;
        state.collapse(from, to);
        let before = made.last().map_or(0.0, |last| last.error);
        made.push(Collapse {
            from,
            to,
            error: before.max(candidate.error),
            n_left: state.links.n_triangles(),
        });
    }
    made
}

/// A possible collapse.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    error: f64,
    /// The removed vertex, and its target.
    edge: [u32; 2],
}

/// The heap's order: the error's bits, which sort like errors, the edge, and the ends' versions.
type Key = Reverse<(u64, [u32; 2], [u32; 2])>;

struct State<'a> {
    links: Links,
    poses: &'a [Vec<Vec3>],
    /// For each pose the quadrics of all vertices.
    quadrics: Vec<Vec<Quadric>>,
    /// For each vertex, the number of changes at it or around it.
    versions: Vec<u32>,
    heap: BinaryHeap<Key>,
}

impl<'a> State<'a> {
    fn new(triangles: &[[u32; 3]], poses: &'a [Vec<Vec3>]) -> Self {
        let n_vertices = poses.iter().map(Vec::len).min().unwrap_or(0);
        let links = Links::new(triangles, n_vertices);
        let quadrics = poses.iter().map(|places| quadrics(&links, triangles, places));
        let mut state = Self {
            quadrics: quadrics.collect(),
            links,
            poses,
            versions: vec![0; n_vertices],
            heap: BinaryHeap::new(),
        };
        for &[a, b, c] in triangles {
            for edge in [[a, b], [b, c], [c, a], [b, a], [c, b], [a, c]] {
                state.push(edge);
            }
        }
        state
    }

    /// The collapse of least error that keeps the link condition and flips no face.
    fn next(&mut self) -> Option<Candidate> {
        while let Some(Reverse((bits, edge, versions))) = self.heap.pop() {
            let [from, to] = edge;
            let is_current = versions == edge.map(|end| self.versions[end as usize]);
            if is_current && self.links.may_collapse(from, to) && !self.turns_over(from, to) {
                return Some(Candidate {
                    error: f64::from_bits(bits),
                    edge,
                });
            }
        }
        None
    }

    fn push(&mut self, edge: [u32; 2]) {
        let error = self.error(edge);
        if error.is_finite() {
            let versions = edge.map(|end| self.versions[end as usize]);
            self.heap.push(Reverse((error.to_bits(), edge, versions)));
        }
    }

    /// The largest error over the poses.
    fn error(&self, [from, to]: [u32; 2]) -> f64 {
        let poses = self.poses.iter().zip(&self.quadrics);
        let errors = poses.map(|(places, quadrics)| {
            let mean = quadrics[from as usize].distance(places[to as usize].as_dvec3());
            mean / MEAN_OF_LARGEST
        });
        errors.fold(0.0, f64::max)
    }

    fn collapse(&mut self, from: u32, to: u32) {
        for quadrics in &mut self.quadrics {
            let moved = quadrics[from as usize];
            quadrics[to as usize].add(&moved);
        }
        self.links.collapse(from, to);
        self.versions[from as usize] += 1;
        self.versions[to as usize] += 1;
        for around in self.links.neighbours(to) {
            self.push([around, to]);
            self.push([to, around]);
        }
    }

    /// Whether a face would flip in one of the poses.
    fn turns_over(&self, from: u32, to: u32) -> bool {
        let mut moved = self
            .links
            .triangles_of(from)
            .filter(|corners| !corners.contains(&to));
        moved.any(|corners| {
            self.poses.iter().any(|places| {
                let place = |corner: u32| places[corner as usize].as_dvec3();
                let before = normal(corners.map(place));
                let after = normal(corners.map(|corner| place(if corner == from { to } else { corner })));
                let is_turned = before.dot(after) < LEAST_COSINE * before.length() * after.length();
                // A face without area before may have any direction.
                before != DVec3::ZERO && (after == DVec3::ZERO || is_turned)
            })
        })
    }
}

/// Twice a triangle's area, along its normal.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Planes of the triangles around each vertex, and perpendicular planes along borders.
fn quadrics(links: &Links, triangles: &[[u32; 3]], places: &[Vec3]) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::NONE; places.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| places[corner as usize].as_dvec3());
        let normal = normal([a, b, c]);
        let area = 0.5 * normal.length();
        let Some(normal) = normal.try_normalize() else {
            continue;
        };
        let plane = Quadric::of_plane(normal, a, area);
        for corner in corners {
            quadrics[*corner as usize].add(&plane);
        }
        for (edge, [from, to]) in [([0, 1], [a, b]), ([1, 2], [b, c]), ([2, 0], [c, a])] {
            let edge = edge.map(|at: usize| corners[at]);
            let along = to - from;
            if let (true, Some(upright)) = (links.is_border(edge), along.cross(normal).try_normalize()) {
                let plane = Quadric::of_plane(upright, from, along.length_squared());
                for end in edge {
                    quadrics[end as usize].add(&plane);
                }
            }
        }
    }
    quadrics
}
