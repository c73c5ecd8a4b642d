//! Adjacency of triangles and vertices during edge collapses.

use std::collections::HashSet;

use crate::geometry::edges::edges;

/// Vertices with more triangles around them stay: a fan of a whole file's triangles would take
/// hours.
const MOST_AROUND: usize = 128;

/// Triangles and their adjacency. A collapsed triangle has no corners in any list.
pub(super) struct Links {
    triangles: Vec<[u32; 3]>,
    /// The triangles at each vertex.
    around: Vec<Vec<u32>>,
    /// Edges with a surface on one side only, lower index first.
    borders: HashSet<[u32; 2]>,
    /// Whether a vertex was on a border initially.
    is_on_border: Vec<bool>,
    n_triangles: usize,
}

impl Links {
    pub(super) fn new(triangles: &[[u32; 3]], n_vertices: usize) -> Self {
        let mut around = vec![Vec::new(); n_vertices];
        for (index, corners) in (0..).zip(triangles) {
            for corner in corners {
                around[*corner as usize].push(index);
            }
        }
        let edges = edges(triangles);
        let borders = edges.iter().filter(|edge| edge.is_border).map(|edge| edge.ends);
        let borders: HashSet<[u32; 2]> = borders.collect();
        let mut is_on_border = vec![false; n_vertices];
        for end in borders.iter().flatten() {
            is_on_border[*end as usize] = true;
        }
        Self {
            triangles: triangles.to_vec(),
            around,
            borders,
            is_on_border,
            n_triangles: triangles.len(),
        }
    }

    pub(super) fn n_triangles(&self) -> usize {
        self.n_triangles
    }

    /// Whether an edge had a surface on one side only initially.
    pub(super) fn is_border(&self, [a, b]: [u32; 2]) -> bool {
        self.borders.contains(&[a.min(b), a.max(b)])
    }

    /// Corners of the triangles around a vertex.
    pub(super) fn triangles_of(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
        let around = self.around[vertex as usize].iter();
        around.map(|index| self.triangles[*index as usize])
    }

    /// Other corners of the triangles around a vertex, sorted.
    pub(super) fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let corners = self.triangles_of(vertex).flatten();
        let mut neighbours: Vec<u32> = corners.filter(|corner| *corner != vertex).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours
    }

    /// Whether a vertex may be moved onto another: their common neighbours are only those of the
    /// removed triangles, of which there is one at a border and two elsewhere. A border's vertex is
    /// only moved along it.
    pub(super) fn may_collapse(&self, from: u32, to: u32) -> bool {
        let n_around = |vertex: u32| self.around[vertex as usize].len();
        if n_around(from).max(n_around(to)) > MOST_AROUND {
            return false;
        }
        let n_shared = self
            .triangles_of(from)
            .filter(|corners| corners.contains(&to))
            .count();
        let [of_from, of_to] = [from, to].map(|end| self.neighbours(end));
        let n_common = of_from
            .iter()
            .filter(|one| of_to.binary_search(one).is_ok())
            .count();
        let is_edge = (1..=2).contains(&n_shared) && n_common == n_shared;
        let is_along = !self.is_on_border[from as usize] || n_shared == 1;
        is_edge && is_along && self.leaves_all(from, to)
    }

    /// Whether a piece of the shape is left, and no two of its triangles have the same corners: a
    /// leaf of two triangles becomes one, and a pyramid stays.
    fn leaves_all(&self, from: u32, to: u32) -> bool {
        let sorted = |mut corners: [u32; 3]| {
            corners.sort_unstable();
            corners
        };
        let staying: Vec<_> = self
            .triangles_of(to)
            .filter(|corners| !corners.contains(&from))
            .map(sorted)
            .collect();
        let mut moved = (self.triangles_of(from))
            .filter(|corners| !corners.contains(&to))
            .map(|corners| sorted(corners.map(|corner| if corner == from { to } else { corner })))
            .peekable();
        let is_any_left = !staying.is_empty() || moved.peek().is_some();
        is_any_left && !moved.any(|corners| staying.contains(&corners))
    }

    pub(super) fn collapse(&mut self, from: u32, to: u32) {
        for index in std::mem::take(&mut self.around[from as usize]) {
            let corners = self.triangles[index as usize];
            if corners.contains(&to) {
                for corner in corners {
                    self.around[corner as usize].retain(|other| *other != index);
                }
                self.n_triangles -= 1;
            } else {
                self.triangles[index as usize] =
                    corners.map(|corner| if corner == from { to } else { corner });
                self.around[to as usize].push(index);
            }
        }
    }
}
