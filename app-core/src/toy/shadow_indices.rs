//! The toy as a shape alone, for passes that need no material: corners in one place are one, and closed pieces are told
//! from open ones.
//!
//! Vertices are split where normals, coordinates or materials change, which shadows do not care about: welded again, a
//! mesh has a fraction of them to transform.
//! Source: the "shadow index buffer" of meshoptimizer; here vertices are one only if no pose can part them.

use std::collections::HashMap;
use std::ops::Range;

use super::geometry::Geometry;
use super::surface::Surface;

/// Triangles of welded corners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShadowIndices {
    /// Corners of triangles, each the first of the vertices that stay with it in every pose.
    pub indices: Vec<u32>,
    /// Which of them to draw.
    pub ranges: ShadowRanges,
}

/// Ranges of [`ShadowIndices::indices`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShadowRanges {
    /// Every triangle once.
    pub all: Range<u32>,
    /// What hides a light where only triangles that face it are drawn: closed pieces once, open ones from both sides.
    ///
    /// A ray to a light outside a closed piece leaves it as often as it enters it, or once more where it starts inside.
    pub facing: Range<u32>,
    /// The same for a light that may be within a closed piece: every triangle from both sides.
    pub both_sides: Range<u32>,
}

impl ShadowRanges {
    /// What to draw from a point, of which only triangles that face it are seen.
    #[must_use]
    pub fn seen_from(&self, is_within_toy: bool) -> Range<u32> {
        if is_within_toy {
            self.both_sides.clone()
        } else {
            self.facing.clone()
        }
    }
}

impl ShadowIndices {
    /// Of the triangles `indices`, three corners each, of surfaces that are laid out one after the other.
    pub(super) fn new(surfaces: &[Surface], geometries: &[Geometry], indices: &[u32]) -> Self {
        let first_alike = first_alike(surfaces, geometries);
        let corners = indices.as_chunks().0.iter();
        let welded = corners.map(|corners: &[u32; 3]| corners.map(|corner| first_alike[corner as usize]));
        // Without area they hide nothing.
        let triangles: Vec<_> = welded.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let mut pieces = Pieces::of(&triangles, first_alike.len());
        let (closed, open): (Vec<_>, Vec<_>) = triangles
            .into_iter()
            .partition(|[corner, ..]| pieces.is_closed(*corner));
        let turned = |[a, b, c]: &[u32; 3]| [*a, *c, *b];
        let sections = [
            closed.clone(),
            open.clone(),
            open.iter().map(turned).collect(),
            closed.iter().map(turned).collect(),
        ];
        let first = |n_triangles: usize| 0..u32::try_from(3 * n_triangles).unwrap_or(u32::MAX);
        Self {
            indices: sections.concat().into_flattened(),
            ranges: ShadowRanges {
                all: first(closed.len() + open.len()),
                facing: first(closed.len() + 2 * open.len()),
                both_sides: first(2 * (closed.len() + open.len())),
            },
        }
    }
}

/// For each vertex of the toy the first that is where it is in every pose.
fn first_alike(surfaces: &[Surface], geometries: &[Geometry]) -> Vec<u32> {
    let mut firsts = HashMap::new();
    let keys = surfaces.iter().flat_map(|surface| {
        let geometry = &geometries[surface.geometry];
        (0..geometry.positions.len()).map(move |vertex| movement(surface, geometry, vertex))
    });
    (0..)
        .zip(keys)
        .map(|(vertex, key)| *firsts.entry(key).or_insert(vertex))
        .collect()
}

/// All that decides where a vertex goes, bit by bit.
fn movement(surface: &Surface, geometry: &Geometry, vertex: usize) -> Vec<u32> {
    let number = |index: usize| u32::try_from(index).unwrap_or(u32::MAX);
    let mut key = vec![
        number(surface.node),
        surface.skin.map_or(u32::MAX, number),
        number(geometry.targets.len()),
    ];
    let offsets = geometry.targets.iter().map(|target| target.offset(vertex));
    let points = offsets.chain([geometry.positions[vertex]]);
    key.extend(points.flat_map(|point| point.to_array().map(f32::to_bits)));
    let influences = geometry.influences.iter().flat_map(|all| all.of(vertex));
    key.extend(influences.flat_map(|(joint, weight)| [u32::from(joint), weight.to_bits()]));
    key
}

/// Triangles that hang together by their corners, and which of these pieces are closed.
struct Pieces {
    /// For each vertex one nearer to the piece's root, which is its own.
    parents: Vec<u32>,
    /// For each root, whether its piece has an edge that is not met from both sides alike.
    is_open: Vec<bool>,
}

impl Pieces {
    fn of(triangles: &[[u32; 3]], n_vertices: usize) -> Self {
        let mut pieces = Self {
            parents: (0..).take(n_vertices).collect(),
            is_open: vec![false; n_vertices],
        };
        // How often an edge is passed upwards, less how often downwards.
        let mut passes: HashMap<[u32; 2], i32> = HashMap::new();
        for &[a, b, c] in triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *passes.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
                pieces.join(from, to);
            }
        }
        for ([corner, _], _) in passes.into_iter().filter(|(_, n)| *n != 0) {
            let root = pieces.root(corner);
            pieces.is_open[root as usize] = true;
        }
        pieces
    }

    fn is_closed(&mut self, corner: u32) -> bool {
        let root = self.root(corner);
        !self.is_open[root as usize]
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parents[corner as usize] != corner {
            // Halves the path for those who come after.
            let parent = self.parents[corner as usize];
            self.parents[corner as usize] = self.parents[parent as usize];
            corner = parent;
        }
        corner
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
