//! The edges between the triangles of a mesh.

use std::collections::BTreeMap;

/// An edge, with all triangles around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, lower index first.
    pub ends: [u32; 2],
    /// The triangle that passes it from the lower to the higher index, and the one that passes it
    /// the other way; `None` if there is not exactly one of each.
    pub beside: Option<[u32; 2]>,
    /// Whether it is passed more often in one direction than in the other.
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

/// Triangles, and edges with at most two triangles each: an edge of more triangles is listed
/// several times, so that the outline of a partly visible mesh is closed.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Its edges.
    pub edges: Vec<PairedEdge>,
}

/// An edge of one or two triangles.
#[derive(Clone, Copy, Debug)]
pub struct PairedEdge {
    /// Ends, in the order of the first triangle.
    pub corners: [u32; 2],
    /// Indices of the triangle that passes the edge in this order, and of the one that passes it
    /// the other way; the number of triangles in place of a missing one.
    pub sides: [u32; 2],
}

impl Faces {
    /// Pairs as many edges as possible, but none of a triangle with its own back side, since both
    /// are never seen together.
    pub fn new(triangles: Vec<[u32; 3]>) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "a toy has far fewer")]
        let none = triangles.len() as u32;
        let mut edges: Vec<PairedEdge> = Vec::with_capacity(2 * triangles.len());
        // Positions of edges with one side, by their ends, with the opposite corner.
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
