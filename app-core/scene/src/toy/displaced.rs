//! The same toy with another shape: vertices are displaced at rest, so that every pose has the
//! displacement.

use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DVec3};

use super::Toy;
use super::error::ToyError;
use super::geometry::Geometry;
use super::moment::Pose;
use super::rig::RigPose;
use super::shadow_indices::first_alike;
use super::surface::Surface;
use crate::geometry::bounds::Bounds;

impl Toy {
    /// For each vertex the first that coincides with it in every pose: both must have the same
    /// displacement, or the surface tears.
    #[must_use]
    pub fn first_alike(&self) -> Vec<u32> {
        first_alike(&self.surfaces, &self.geometries)
    }

    /// This toy with its vertices displaced in a pose, in object space, and in every other pose by
    /// the carried displacement; normals follow the triangles. `displacements` has one entry per
    /// vertex; missing ones mean no displacement, and vertices that the pose flattens stay.
    /// Triangles, materials and clips are this toy's.
    ///
    /// # Errors
    /// As [`Toy::pose`].
    pub fn displaced(&self, pose: &Pose, displacements: &[DVec3]) -> Result<Self, ToyError> {
        let rig_pose = self.rig_pose(pose, DAffine3::IDENTITY)?;
        let geometries = self.geometries.iter().enumerate();
        let geometries = geometries.map(|(index, geometry)| {
            let drawn: Vec<&Surface> = self.surfaces.iter().filter(|s| s.geometry == index).collect();
            displaced(geometry, &drawn, &rig_pose, displacements)
        });
        Ok(Self {
            file: self.file.clone(),
            rig: Arc::clone(&self.rig),
            geometries: geometries.collect(),
            surfaces: Arc::clone(&self.surfaces),
            draws: Arc::clone(&self.draws),
            shadow_indices: Arc::clone(&self.shadow_indices),
            casters: OnceLock::new(),
            welded: Arc::clone(&self.welded),
            materials: self.materials.clone(),
            textures: Arc::clone(&self.textures),
            warnings: self.warnings.clone(),
        })
    }
}

/// Limit for a vertex's displacement, over the diagonal of its geometry's box.
const MOST_OF_EXTENT: f64 = 0.1;

/// A geometry with each vertex moved by the mean displacement over its surfaces.
fn displaced(geometry: &Geometry, drawn: &[&Surface], pose: &RigPose, displacements: &[DVec3]) -> Geometry {
    let mut out = geometry.clone();
    let bounds = Bounds::around(geometry.positions.iter().map(|position| position.as_dvec3()));
    let most = MOST_OF_EXTENT * (bounds.max - bounds.min).length();
    for (vertex, position) in out.positions.iter_mut().enumerate() {
        let in_mesh = drawn.iter().filter_map(|surface| {
            let displacement = *displacements.get(surface.first_vertex + vertex)?;
            let anchor_from_mesh = surface.anchor_from_mesh(geometry, vertex, pose);
            let in_mesh = anchor_from_mesh.matrix3.inverse() * displacement;
            // A pose that nearly flattens a part does not constrain its shape.
            (in_mesh.length() <= most).then_some(in_mesh)
        });
        let (sum, n_told) = in_mesh.fold((DVec3::ZERO, 0.0), |(sum, n), one| (sum + one, n + 1.0));
        if sum != DVec3::ZERO {
            *position = (position.as_dvec3() + sum / n_told).as_vec3();
        }
    }
    turn_normals(geometry, &mut out);
    out
}

/// Rotates the normals of a displaced geometry like the triangles around them.
fn turn_normals(before: &Geometry, after: &mut Geometry) {
    let Some(mut normals) = after.normals.take() else {
        return;
    };
    let turned = face_normals(before).into_iter().zip(face_normals(after));
    for (normal, (before, after)) in normals.iter_mut().zip(turned) {
        if before != after {
            *normal = (normal.as_dvec3() + after - before)
                .as_vec3()
                .normalize_or(*normal);
        }
    }
    after.normals = Some(normals);
}

/// For each vertex the unit normal of its triangles, weighted by area; zero if they have none.
fn face_normals(geometry: &Geometry) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; geometry.positions.len()];
    for corners in geometry.triangles() {
        let [a, b, c] = corners.map(|corner| geometry.positions[corner as usize].as_dvec3());
        for corner in corners {
            normals[*corner as usize] += (b - a).cross(c - a);
        }
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}
