//! The toy's shape alone, for passes without materials: vertices are welded by position, and closed
//! pieces are separated from open ones.
//!
//! Vertices are split at changes of normals, coordinates or materials, which shadows do not depend
//! on: after welding, a fraction of them is left to transform. Source: the "shadow index buffer" of
//! meshoptimizer; here vertices are welded only if no pose can separate them.

use std::collections::HashMap;

use glam::Vec3;

use super::geometry::{Geometry, MorphTarget, place_bits};
use super::pieces::Pieces;
use super::surface::Surface;

/// Triangles of welded corners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShadowIndices {
    /// Corners of triangles, each the first of the vertices that coincide with it in every pose:
    /// closed pieces first, then open ones.
    pub indices: Vec<u32>,
    /// Number of corners of closed pieces, whose faces look outwards.
    pub n_closed: usize,
    /// For each of the toy's own triangles, whether it belongs to a closed piece.
    pub is_of_closed: Vec<bool>,
}

impl ShadowIndices {
    /// Builds it from the triangles `indices`, three corners each, of consecutive surfaces. Pieces
    /// that clips mirror count as open: their faces look inwards at times.
    pub(super) fn new(
        surfaces: &[Surface],
        geometries: &[Geometry],
        indices: &[u32],
        is_mirrored: &[bool],
    ) -> Self {
        let first_alike = first_alike(surfaces, geometries);
        let corners = indices.as_chunks().0.iter();
        let welded: Vec<_> = corners
            .map(|corners: &[u32; 3]| corners.map(|corner| first_alike[corner as usize]))
            .collect();
        // Triangles without area hide nothing.
        let has_area = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        let triangles: Vec<_> = welded.iter().copied().filter(has_area).collect();
        let places = surfaces
            .iter()
            .flat_map(|surface| &geometries[surface.geometry].positions);
        let mut pieces = Pieces::of(&triangles, &places.copied().collect::<Vec<_>>());
        let is_turned = |vertex: u32| {
            let of = surfaces.partition_point(|surface| surface.first_vertex <= vertex as usize);
            of > 0 && is_mirrored[of - 1]
        };
        let mut is_closed = |vertex: u32| pieces.is_closed(vertex) && !is_turned(vertex);
        let is_of_closed = welded
            .iter()
            .map(|corners| has_area(corners) && is_closed(corners[0]))
            .collect();
        let (closed, open): (Vec<_>, Vec<_>) =
            triangles.into_iter().partition(|[corner, ..]| is_closed(*corner));
        Self {
            n_closed: 3 * closed.len(),
            is_of_closed,
            indices: [closed, open].concat().into_flattened(),
        }
    }

    /// Whether every triangle belongs to a closed piece, so that the triangles facing an outside
    /// point occlude all that the toy does: a ray to it leaves a piece as often as it enters it, or
    /// once more if it starts inside.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.n_closed == self.indices.len()
    }

    /// Triangles of which those facing an eye cover the whole toy: those of open pieces are
    /// included twice, once per side.
    pub fn facing_anywhere(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let triangles = |indices| <[u32]>::as_chunks::<3>(indices).0.iter().copied();
        let open = triangles(&self.indices[self.n_closed..]);
        triangles(&self.indices).chain(open.map(|[a, b, c]| [a, c, b]))
    }
}

/// For each vertex of the toy the first that coincides with it in every pose.
pub(super) fn first_alike(surfaces: &[Surface], geometries: &[Geometry]) -> Vec<u32> {
    let movements = movements(geometries);
    let mut firsts = HashMap::new();
    let keys = surfaces.iter().flat_map(|surface| {
        let of_geometry = movements[surface.geometry].iter();
        of_geometry.map(move |movement| (surface.node, surface.skin, *movement))
    });
    (0..)
        .zip(keys)
        .map(|(vertex, key)| *firsts.entry(key).or_insert(vertex))
        .collect()
}

/// For each vertex of each geometry an index that it shares with all vertices that always move
/// alike, drawn by the same node.
fn movements(geometries: &[Geometry]) -> Vec<Vec<usize>> {
    let mut known = HashMap::new();
    let mut number = |key: Vec<u32>| {
        let next = known.len();
        *known.entry(key).or_insert(next)
    };
    geometries
        .iter()
        .map(|geometry| {
            // Most of a file's targets may move nothing.
            let targets = (0..).zip(&geometry.targets);
            let moving: Vec<_> = targets.filter(|(_, target)| target.moves()).collect();
            (0..geometry.positions.len())
                .map(|vertex| number(movement(geometry, &moving, vertex)))
                .collect()
        })
        .collect()
}

/// All that determines a vertex's position in its node, bit by bit.
fn movement(geometry: &Geometry, moving: &[(u32, &MorphTarget)], vertex: usize) -> Vec<u32> {
    let mut key = place_bits(geometry.positions[vertex]).to_vec();
    for (index, target) in moving {
        let offset = target.offset(vertex);
        if offset != Vec3::ZERO {
            key.push(*index);
            key.extend(place_bits(offset));
        }
    }
    key.push(u32::MAX);
    let influences = geometry.influences.iter().flat_map(|all| all.of(vertex));
    key.extend(influences.flat_map(|(joint, weight)| [u32::from(joint), weight.to_bits()]));
    key
}
