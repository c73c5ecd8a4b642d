//! Triangles, and the edges between them.

use std::collections::BTreeMap;

/// The triangles of a mesh with every edge that two of them share, or one has alone.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    /// Corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Its edges.
    pub edges: Vec<Edge>,
}

/// An edge of one or two triangles.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// In the order in which the first of the triangles has them.
    pub corners: [u32; 2],
    /// Indices of the triangle that has the corners in this order, and of the one that has them the other way round; where there is
    /// none, the number of triangles.
    pub sides: [u32; 2],
}

impl Faces {
    /// Pairs the edges: as many as can be, but none of a triangle with that of its own other side, which is never seen beside it.
    pub fn new(triangles: Vec<[u32; 3]>) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "a toy has far fewer")]
        let none = triangles.len() as u32;
        let mut edges: Vec<Edge> = Vec::with_capacity(2 * triangles.len());
        // Places of edges that have one side, by their corners, with the corner opposite.
        let mut open: BTreeMap<[u32; 2], Vec<(usize, u32)>> = BTreeMap::new();
        for (index, [a, b, c]) in (0..).zip(&triangles) {
            for [from, to, opposite] in [[*a, *b, *c], [*b, *c, *a], [*c, *a, *b]] {
                let others = open.entry([to, from]).or_default();
                if let Some(other) = others.iter().position(|(_, corner)| *corner != opposite) {
                    let (edge, _) = others.remove(other);
                    edges[edge].sides[1] = index;
                } else {
                    open.entry([from, to]).or_default().push((edges.len(), opposite));
                    edges.push(Edge {
                        corners: [from, to],
                        sides: [index, none],
                    });
                }
            }
        }
        Self { triangles, edges }
    }
}
