//! Posing: the vertices of a toy at one moment of a clip.

use glam::{DAffine3, DMat4, DVec3, Vec3};

use super::Toy;
use super::error::ToyError;
use super::geometry::{ActiveTarget, Geometry};
use super::graph::Local;
use super::limits::{MAX_NUMBER, MAX_POSED_M};
use super::moment::{NodeId, NodePose, Pose};
use super::normal::{carried_normal, face_normal};
use super::rig::{RigPose, Set};
use super::surface::Surface;

/// The vertices of a posed toy. Reuse it from frame to frame to save allocations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosedMesh {
    /// One for each vertex, in anchor space.
    pub positions: Vec<Vec3>,
    /// One for each vertex, of unit length, outward, in anchor space.
    pub normals: Vec<Vec3>,
}

impl PosedMesh {
    /// The positions in 64 bits.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.positions.iter().map(|position| position.as_dvec3())
    }
}

impl Toy {
    /// Poses the toy, and writes positions and normals.
    ///
    /// `anchor_from_object` is affine and does not mirror; object space is that of the glTF scene.
    /// A time beyond the clip shows its end. Everything is composed in 64 bits and stored in 32.
    /// Where an animated scale changes sign, normals stay outward, but the triangles' winding is
    /// that at rest; those that a clip mirrors count as open, and are drawn from both sides.
    ///
    /// # Errors
    /// An id of another toy, an invalid time or transform, or a position that is not from
    /// -1e6 m to 1e6 m along each axis.
    pub fn pose(&self, pose: &Pose, anchor_from_object: &DMat4, out: &mut PosedMesh) -> Result<(), ToyError> {
        let rig_pose = self.rig_pose(pose, DAffine3::from_mat4(*anchor_from_object))?;
        out.positions.resize(self.n_vertices(), Vec3::ZERO);
        out.normals.resize(self.n_vertices(), Vec3::Y);
        for surface in self.surfaces.iter() {
            let geometry = &self.geometries[surface.geometry];
            let active = geometry.active_targets(self.rig.morph_weights(&rig_pose, surface.node));
            let vertices = surface.first_vertex..surface.first_vertex + geometry.positions.len();
            let positions = &mut out.positions[vertices.clone()];
            let normals = &mut out.normals[vertices];
            pose_surface(surface, geometry, &rig_pose, &active, (positions, normals));
        }
        self.check_positions(&out.positions)
    }

    pub(super) fn rig_pose(&self, pose: &Pose, anchor_from_object: DAffine3) -> Result<RigPose, ToyError> {
        Ok(self.rig.pose(&self.set(pose)?, anchor_from_object))
    }

    /// Each node's transform to its parent in a pose, and the weights of all morph targets.
    pub(super) fn locals(&self, pose: &Pose) -> Result<(Vec<Local>, Vec<f64>), ToyError> {
        Ok(self.rig.locals(&self.set(pose)?))
    }

    fn set<'a>(&'a self, pose: &'a Pose) -> Result<Set<'a>, ToyError> {
        Ok(match pose {
            Pose::Authored => Set::Authored,
            Pose::Clip { clip, time_secs } => {
                Set::Clip(self.clip(*clip)?, self.clamp_time(*clip, *time_secs)?.0)
            }
            Pose::Nodes(pose) => {
                self.check_nodes(pose)?;
                Set::Nodes(pose)
            }
        })
    }

    fn check_nodes(&self, pose: &NodePose) -> Result<(), ToyError> {
        let flaw = |node: NodeId, reason| {
            Err(ToyError::NodePose {
                file: self.file.clone(),
                node: node.0,
                reason,
            })
        };
        for (id, trs) in &pose.parent_from_node {
            self.node(*id)?;
            if !(trs.translation.is_finite() && trs.rotation.is_finite() && trs.scale.is_finite()) {
                return flaw(*id, "its transform is not finite");
            }
            let largest = trs.translation.abs().max(trs.scale.abs()).max_element();
            if largest > MAX_NUMBER {
                return flaw(*id, "its transform is not from -1000000000000 to 1000000000000");
            }
            // Neither zero nor out of range when squared.
            if !trs.rotation.length_recip().is_normal() {
                return flaw(*id, "its rotation is no quaternion that can be normalised");
            }
        }
        for (id, weights) in &pose.morph_weights {
            if weights.len() != self.node(*id)?.morph_weights.len() {
                return flaw(*id, "it has another number of morph weights");
            }
            if !weights.iter().all(|weight| weight.is_finite()) {
                return flaw(*id, "a morph weight is not finite");
            }
            if weights.iter().any(|weight| weight.abs() > MAX_NUMBER) {
                return flaw(*id, "a morph weight is not from -1000000000000 to 1000000000000");
            }
        }
        Ok(())
    }

    fn check_positions(&self, positions: &[Vec3]) -> Result<(), ToyError> {
        let is_outside = |position: &Vec3| !is_within(*position, MAX_POSED_M);
        match positions.iter().position(is_outside) {
            Some(vertex) => Err(self.overflow(vertex, MAX_POSED_M)),
            None => Ok(()),
        }
    }

    pub(super) fn overflow(&self, vertex: usize, max: f64) -> ToyError {
        ToyError::PoseOverflow {
            file: self.file.clone(),
            vertex,
            max,
        }
    }
}

/// Whether the absolute value of each coordinate is at most `max`.
pub(super) fn is_within(position: Vec3, max: f64) -> bool {
    position
        .to_array()
        .iter()
        .all(|coordinate| f64::from(coordinate.abs()) <= max)
}

fn pose_surface(
    surface: &Surface,
    geometry: &Geometry,
    pose: &RigPose,
    active: &[ActiveTarget],
    (positions, normals): (&mut [Vec3], &mut [Vec3]),
) {
    // Without normals, each triangle has three consecutive vertices of its own.
    let mut corners = [DVec3::ZERO; 3];
    surface.deform(geometry, pose, active, |vertex, position, anchor_from_mesh| {
        let linear = &anchor_from_mesh.matrix3;
        positions[vertex] = position.as_vec3();
        if let Some(smooth) = &geometry.normals {
            let normal = Geometry::morphed_normal(smooth, vertex, active);
            normals[vertex] = carried_normal(linear, normal);
            return;
        }
        corners[vertex % 3] = position;
        if vertex % 3 == 2 {
            normals[vertex - 2..=vertex].fill(face_normal(linear, corners));
        }
    });
}
