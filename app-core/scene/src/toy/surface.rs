//! Drawn surfaces: a primitive at a node, and its range of the toy's vertex and index buffers.

use std::ops::Range;

use glam::{DAffine3, DVec3, Vec2, Vec4};

use super::geometry::{ActiveTarget, Geometry};
use super::rig::RigPose;

/// One draw: a range of triangles with one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Index into [`Toy::materials`](super::Toy::materials).
    pub material: usize,
    /// Range of [`Toy::indices`](super::Toy::indices), three to a triangle.
    pub indices: Range<u32>,
}

/// A primitive drawn by one node; its vertices are contiguous in the toy's buffers.
pub(super) struct Surface {
    /// Index into the toy's geometries.
    pub(super) geometry: usize,
    pub(super) node: usize,
    /// The skin that moves it; if `None`, the node does.
    pub(super) skin: Option<usize>,
    pub(super) material: usize,
    pub(super) first_vertex: usize,
    /// Whether it is mirrored at rest, so that its triangles are reversed.
    pub(super) is_mirrored: bool,
}

impl Surface {
    /// Transform of one vertex of the surface.
    pub(super) fn anchor_from_mesh(&self, geometry: &Geometry, vertex: usize, pose: &RigPose) -> DAffine3 {
        match (&geometry.influences, self.skin) {
            (Some(influences), Some(skin)) => influences.blend(vertex, &pose.anchor_from_mesh_by_joint[skin]),
            _ => pose.anchor_from_node[self.node],
        }
    }

    /// Visits each vertex with its posed position and its transform.
    pub(super) fn deform(
        &self,
        geometry: &Geometry,
        pose: &RigPose,
        active: &[ActiveTarget],
        mut visit: impl FnMut(usize, DVec3, &DAffine3),
    ) {
        for vertex in 0..geometry.positions.len() {
            let anchor_from_mesh = self.anchor_from_mesh(geometry, vertex, pose);
            let position = anchor_from_mesh.transform_point3(geometry.morphed_position(vertex, active));
            visit(vertex, position, &anchor_from_mesh);
        }
    }
}

/// Whether most vertices have a mirroring transform.
pub(super) fn is_mirrored(surface: &Surface, geometry: &Geometry, rest: &RigPose) -> bool {
    let n = n_transforms(surface, geometry);
    let mirrors = |&v: &usize| surface.anchor_from_mesh(geometry, v, rest).matrix3.determinant() < 0.0;
    2 * (0..n).filter(mirrors).count() > n
}

/// Number of vertices, from the first on, that have all of the surface's transforms: one if the
/// node moves the surface, else all.
pub(super) fn n_transforms(surface: &Surface, geometry: &Geometry) -> usize {
    match (&geometry.influences, surface.skin) {
        (Some(_), Some(_)) => geometry.positions.len(),
        _ => geometry.positions.len().min(1),
    }
}

/// Pose-independent data of draws: triangles, coordinates and colours.
#[derive(Default)]
pub(super) struct Draws {
    pub(super) parts: Vec<Part>,
    pub(super) indices: Vec<u32>,
    pub(super) uvs: Vec<[f32; 2]>,
    /// Empty if no surface has colours.
    pub(super) colors_linear: Vec<[f32; 4]>,
}

/// Lays the surfaces out in common buffers. The limits keep vertices and indices far below 2^32.
pub(super) fn lay_out(surfaces: &[Surface], geometries: &[Geometry]) -> Draws {
    let mut draws = Draws::default();
    let has_colors = surfaces
        .iter()
        .any(|surface| geometries[surface.geometry].colors.is_some());
    for surface in surfaces {
        let geometry = &geometries[surface.geometry];
        let n_vertices = geometry.positions.len();
        let first_index = index(draws.indices.len());
        let first_vertex = index(surface.first_vertex);
        for &[a, b, c] in geometry.indices.as_chunks().0 {
            let corners = if surface.is_mirrored { [a, c, b] } else { [a, b, c] };
            draws.indices.extend(corners.map(|corner| first_vertex + corner));
        }
        draws.parts.push(Part {
            material: surface.material,
            indices: first_index..index(draws.indices.len()),
        });
        let n_so_far = surface.first_vertex + n_vertices;
        draws
            .uvs
            .extend(geometry.uvs.iter().flatten().map(Vec2::to_array));
        draws.uvs.resize(n_so_far, [0.0; 2]);
        if has_colors {
            draws
                .colors_linear
                .extend(geometry.colors.iter().flatten().map(Vec4::to_array));
            draws.colors_linear.resize(n_so_far, [1.0; 4]);
        }
    }
    draws
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "vertices and indices are counted before they are laid out"
)]
fn index(value: usize) -> u32 {
    value as u32
}
