//! Pieces of a shape: connected components, and whether they are closed or inside out.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::disjoint::DisjointSets;
use crate::geometry::edges::edges;

/// Connected components of triangles.
pub(super) struct Pieces {
    /// Vertices that edges connect.
    connected: DisjointSets,
    /// For each root, whether its piece has an edge with unequal numbers of triangles on both
    /// sides.
    is_open: Vec<bool>,
    /// Volume of each piece, by its root.
    volumes: HashMap<usize, Volume>,
}

/// Six times a volume: negative if faces look inwards.
#[derive(Clone, Copy, Default)]
struct Volume {
    signed: f64,
    /// Bound on its rounding error.
    rounding: f64,
}

impl Pieces {
    /// Pieces of triangles. `places` are the positions of all vertices, each in its node.
    pub(super) fn of(triangles: &[[u32; 3]], places: &[Vec3]) -> Self {
        let mut pieces = Self {
            connected: DisjointSets::new(places.len()),
            is_open: vec![false; places.len()],
            volumes: HashMap::new(),
        };
        let edges = edges(triangles);
        for [from, to] in edges.iter().map(|edge| edge.ends) {
            pieces.connected.join(from as usize, to as usize);
        }
        for edge in edges.iter().filter(|edge| edge.is_border) {
            let root = pieces.root(edge.ends[0]);
            pieces.is_open[root] = true;
        }
        for corners in triangles {
            let root = pieces.root(corners[0]);
            let corners = corners.map(|corner| places[corner as usize].as_dvec3());
            pieces.volumes.entry(root).or_default().add(corners);
        }
        pieces
    }

    /// Whether the piece of a vertex is closed, and its faces look outwards.
    pub(super) fn is_closed(&mut self, corner: u32) -> bool {
        self.closed_volume(corner)
            .is_some_and(|volume| volume.signed > 0.0)
    }

    /// Whether it is closed and certainly inside out: the volume of a two-sided sheet is nothing
    /// but rounding.
    pub(super) fn is_inside_out(&mut self, corner: u32) -> bool {
        self.closed_volume(corner)
            .is_some_and(|volume| volume.signed < -volume.rounding)
    }

    /// The vertex that represents the piece of another one: its first.
    pub(super) fn root(&mut self, corner: u32) -> usize {
        self.connected.first(corner as usize)
    }

    fn closed_volume(&mut self, corner: u32) -> Option<Volume> {
        let root = self.root(corner);
        let volume = self.volumes.get(&root).copied();
        volume.filter(|_| !self.is_open[root])
    }
}

impl Volume {
    /// Adds the tetrahedron from the origin to a triangle.
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        // Products of three numbers of 32 bits, in sums of nine: one rounding each, and those of
        // the sum.
        const N_ROUNDINGS: f64 = 16.0;
        self.signed += a.dot(b.cross(c));
        self.rounding += N_ROUNDINGS * f64::EPSILON * a.length() * b.length() * c.length();
    }
}
