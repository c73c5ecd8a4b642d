//! The edges between the triangles of a mesh.

use std::collections::BTreeMap;

/// An edge, with all triangles that have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, lower index first.
    pub ends: [u32; 2],
    /// The triangle that passes it from the lower to the higher index, and the one that passes it the other way; none if there are
    /// not one of each.
    pub beside: Option<[u32; 2]>,
    /// Whether it is not passed as often one way as the other.
    pub is_border: bool,
}

/// Every edge of some triangles, in the order of their ends.
#[must_use]
pub fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    // Ends, whether it is passed from the higher index to the lower, and the triangle.
    let mut passes: Vec<([u32; 2], bool, u32)> = Vec::with_capacity(3 * triangles.len());
    for (index, &[a, b, c]) in (0..).zip(triangles) {
        let sides = [[a, b], [b, c], [c, a]];
        passes.extend(sides.map(|[from, to]| ([from.min(to), from.max(to)], from > to, index)));
    }
    passes.sort_unstable();
    let of_edge = passes.chunk_by(|one, other| one.0 == other.0);
    let edges = of_edge.map(|passes| Edge {
        ends: passes[0].0,
        beside: match passes {
            [(_, false, one), (_, true, other)] => Some([*one, *other]),
            _ => None,
        },
        is_border: 2 * passes.iter().filter(|(_, is_back, _)| *is_back).count() != passes.len(),
    });
    edges.collect()
}

/// Triangles, and edges with at most two of them beside each: an edge of more stands there several times, so that a mesh of which only
/// some triangles are seen has an outline that is closed.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    /// Corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Its edges.
    pub edges: Vec<PairedEdge>,
}

/// An edge of one or two triangles.
#[derive(Clone, Copy, Debug)]
pub struct PairedEdge {
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
        let mut edges: Vec<PairedEdge> = Vec::with_capacity(2 * triangles.len());
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
                    edges.push(PairedEdge {
                        corners: [from, to],
                        sides: [index, none],
                    });
                }
            }
        }
        Self { triangles, edges }
    }
}
