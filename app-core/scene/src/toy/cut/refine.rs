//! Divides triangles at the crossing of alpha and cutoff, and cuts them there.
//!
//! Edges are divided: all triangles at an edge are divided with it, so that no gap opens. The
//! longest edge of a triangle goes first, which keeps angles from becoming ever sharper. Source:
//! Rivara, Algorithms for refinement of triangular grids, 1984 (longest-edge bisection).

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use glam::{Vec2, Vec3};

use super::field::{Corner, Field};
use super::welded::welded;
use crate::toy::geometry::Geometry;

/// The shortest edges to divide.
pub(super) struct Finest {
    pub(super) texels: f32,
    /// Length in units of the file.
    pub(super) length: f64,
}

/// A new vertex on the line between two earlier ones.
#[derive(Clone, Copy)]
pub(super) struct Made {
    pub(super) from: u32,
    pub(super) to: u32,
    /// Position from 0 at `from` to 1 at `to`.
    pub(super) part: f32,
}

/// Triangles of a geometry, and their vertices in addition to its own.
pub(super) struct Mesh {
    places: Vec<Vec3>,
    corners: Vec<Corner>,
    /// The vertices after the geometry's own.
    pub(super) made: Vec<Made>,
    pub(super) triangles: Vec<[u32; 3]>,
}

type Edge = [u32; 2];

fn edge(a: u32, b: u32) -> Edge {
    [a.min(b), a.max(b)]
}

fn edges([a, b, c]: [u32; 3]) -> [Edge; 3] {
    [edge(a, b), edge(b, c), edge(c, a)]
}

fn corners(geometry: &Geometry) -> Vec<Corner> {
    let uvs = geometry.uvs.as_deref().unwrap_or_default();
    let colors = geometry.colors.as_deref().unwrap_or_default();
    let corner = |vertex: usize| Corner {
        uv: uvs.get(vertex).copied().unwrap_or_default(),
        alpha: colors.get(vertex).map_or(1.0, |color| color.w),
    };
    (0..geometry.positions.len()).map(corner).collect()
}

/// Whether any part of a geometry is transparent, even slightly.
pub(super) fn is_clear(geometry: &Geometry, field: &Field) -> bool {
    let corners = corners(geometry);
    let mut triangles = geometry.triangles().iter();
    triangles.any(|triangle| field.is_clear(triangle.map(|vertex| corners[vertex as usize])))
}

/// Divides all triangles that may be cut; `None` if there would be more than `most`.
pub(super) fn refined(geometry: &Geometry, field: &Field, finest: &Finest, most: usize) -> Option<Mesh> {
    let mut mesh = Mesh {
        corners: corners(geometry),
        places: geometry.positions.clone(),
        made: Vec::new(),
        triangles: welded(geometry),
    };
    // Earlier ones are known to be whole, or fine enough.
    let mut is_open = vec![true; mesh.triangles.len()];
    loop {
        let marked = mesh.marked(field, finest, &is_open);
        if marked.is_empty() {
            return Some(mesh);
        }
        is_open = mesh.divide(marked);
        if mesh.triangles.len() > most {
            return None;
        }
    }
}

impl Mesh {
    fn corner(&self, vertex: u32) -> Corner {
        self.corners[vertex as usize]
    }

    fn texels(&self, field: &Field, [a, b]: Edge) -> f32 {
        field.texels(self.corner(a).uv - self.corner(b).uv).length()
    }

    fn longest(&self, field: &Field, triangle: [u32; 3]) -> Edge {
        let [mut longest, second, third] = edges(triangle);
        for edge in [second, third] {
            if self.texels(field, edge) > self.texels(field, longest) {
                longest = edge;
            }
        }
        longest
    }

    /// Edges to divide: those of triangles that may be cut, and the longest edge of each triangle
    /// with one of these.
    fn marked(&self, field: &Field, finest: &Finest, is_open: &[bool]) -> HashMap<Edge, u32> {
        let is_long = |edge: &Edge| {
            let [a, b] = edge.map(|vertex| self.places[vertex as usize]);
            self.texels(field, *edge) > finest.texels && f64::from(a.distance(b)) > finest.length
        };
        let open = self
            .triangles
            .iter()
            .zip(is_open)
            .filter(|(_, is_open)| **is_open);
        let cut = open.filter(|(triangle, _)| field.may_cut(triangle.map(|vertex| self.corner(vertex))));
        let mut marked: HashSet<Edge> = cut
            .flat_map(|(triangle, _)| edges(*triangle))
            .filter(is_long)
            .collect();
        while !marked.is_empty() {
            let n_before = marked.len();
            for triangle in &self.triangles {
                if edges(*triangle).iter().any(|edge| marked.contains(edge)) {
                    marked.insert(self.longest(field, *triangle));
                }
            }
            if marked.len() == n_before {
                break;
            }
        }
        let mut sorted: Vec<Edge> = marked.into_iter().collect();
        // Sorted, so that the same file gives the same vertices.
        sorted.sort_unstable();
        let first = self.corners.len();
        let numbers = (first..).filter_map(|number| u32::try_from(number).ok());
        sorted.into_iter().zip(numbers).collect()
    }

    /// Divides edges, and all triangles at them; returns which triangles are new.
    fn divide(&mut self, marked: HashMap<Edge, u32>) -> Vec<bool> {
        let mut sorted: Vec<(Edge, u32)> = marked.iter().map(|(edge, number)| (*edge, *number)).collect();
        sorted.sort_unstable_by_key(|(_, number)| *number);
        for ([from, to], _) in sorted {
            self.make(Made { from, to, part: 0.5 });
        }
        let mut is_new = Vec::new();
        let mut divided = Vec::with_capacity(2 * self.triangles.len());
        for triangle in &self.triangles {
            let before = divided.len();
            halve(*triangle, &marked, &self.corners, &mut divided);
            is_new.resize(divided.len(), divided.len() > before + 1);
        }
        self.triangles = divided;
        is_new
    }

    fn make(&mut self, made: Made) -> u32 {
        let (a, b) = (self.corner(made.from), self.corner(made.to));
        self.corners.push(Corner {
            uv: a.uv.lerp(b.uv, made.part),
            alpha: a.alpha + (b.alpha - a.alpha) * made.part,
        });
        let [from, to] = [made.from, made.to].map(|vertex| self.places[vertex as usize]);
        self.places.push(from.lerp(to, made.part));
        self.made.push(made);
        // Triangles are limited, and vertices are fewer than three times their number.
        u32::try_from(self.places.len() - 1).unwrap_or(u32::MAX)
    }

    /// Cuts triangles along the crossing; `None` if nothing is removed.
    pub(super) fn cut(mut self, field: &Field) -> Option<Self> {
        let margins: Vec<f32> = self.corners.iter().map(|corner| field.margin(*corner)).collect();
        let margin = |vertex: u32| margins[vertex as usize];
        if self
            .triangles
            .iter()
            .flatten()
            .all(|vertex| margin(*vertex) >= 0.0)
        {
            return None;
        }
        let mut crossings = HashMap::new();
        let mut left = Vec::with_capacity(self.triangles.len());
        for [a, b, c] in std::mem::take(&mut self.triangles) {
            // Rotated, so that opaque corners come first.
            let turned = [[a, b, c], [b, c, a], [c, a, b]];
            let is_in = |vertex: u32| margin(vertex) >= 0.0;
            let n_in = [a, b, c].into_iter().filter(|vertex| is_in(*vertex)).count();
            let starts = |[first, second, _]: &[u32; 3]| is_in(*first) && (n_in == 1 || is_in(*second));
            let mut crossing = |inside: u32, outside: u32| match crossings.entry(edge(inside, outside)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(new) => {
                    let [from, to] = *new.key();
                    let part = margin(from) / (margin(from) - margin(to));
                    *new.insert(self.make(Made { from, to, part }))
                }
            };
            match (n_in, turned.into_iter().find(starts)) {
                (3, _) => left.push([a, b, c]),
                (2, Some([a, b, c])) => {
                    let (beside_b, beside_a) = (crossing(b, c), crossing(a, c));
                    left.extend([[a, b, beside_b], [a, beside_b, beside_a]]);
                }
                (1, Some([a, b, c])) => left.push([a, crossing(a, b), crossing(a, c)]),
                _ => {}
            }
        }
        self.triangles = left;
        Some(self)
    }
}

/// Divides a triangle at the midpoints of its marked edges, of which the longest is one.
fn halve(triangle: [u32; 3], marked: &HashMap<Edge, u32>, corners: &[Corner], out: &mut Vec<[u32; 3]>) {
    let length = |[a, b]: Edge| {
        let [a, b]: [Vec2; 2] = [a, b].map(|vertex| corners[vertex as usize].uv);
        a.distance_squared(b)
    };
    let [a, b, c] = triangle;
    let turned = [[a, b, c], [b, c, a], [c, a, b]];
    let divided = turned.into_iter().filter_map(|[a, b, c]| {
        let middle = *marked.get(&edge(a, b))?;
        Some(([a, b, c], middle, length(edge(a, b))))
    });
    match divided.max_by(|one, other| one.2.total_cmp(&other.2)) {
        None => out.push(triangle),
        Some(([a, b, c], middle, _)) => {
            halve([a, middle, c], marked, corners, out);
            halve([middle, b, c], marked, corners, out);
        }
    }
}
