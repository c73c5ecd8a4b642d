//! A mesh of the place around the toy, as a scanner measures it.

use std::fmt;
use std::sync::Arc;

use glam::{DMat4, Vec3};
use serde_json::json;

use crate::scene::check::{self, COORDINATE_M, FieldError, UNCERTAINTY_M};
use crate::toy::{Pose, PosedMesh, Toy, ToyError, binary_gltf};

/// Maximum number of triangles.
pub const MAX_PLACE_TRIANGLES: usize = 250_000;
/// Maximum number of points.
pub const MAX_PLACE_POINTS: usize = 3 * MAX_PLACE_TRIANGLES;

/// Triangles of the surfaces of a place, in world space, in metres.
#[derive(Clone)]
pub struct PlaceMesh {
    points: Arc<[Vec3]>,
    /// Corners, in either winding.
    triangles: Arc<[[u32; 3]]>,
    deviation_m: Option<f64>,
}

impl fmt::Debug for PlaceMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n_triangles = self.triangles.len();
        write!(f, "PlaceMesh({n_triangles} triangles, {:?} m)", self.deviation_m)
    }
}

impl PlaceMesh {
    /// A mesh of points in world space, in metres, and of triangles with the indices of their
    /// corners. `deviation_m` is the standard deviation of a point, if it is known.
    ///
    /// # Errors
    /// When there is no point or no triangle, there are too many, a corner does not exist, or a number is out
    /// of range.
    pub fn new(
        points: impl Into<Arc<[Vec3]>>,
        triangles: impl Into<Arc<[[u32; 3]]>>,
        deviation_m: Option<f64>,
    ) -> Result<Self, FieldError> {
        let (points, triangles) = (points.into(), triangles.into());
        check::at_most(points.len(), MAX_PLACE_POINTS)?;
        check::at_most(triangles.len(), MAX_PLACE_TRIANGLES)?;
        if points.is_empty() || triangles.is_empty() {
            return Err(FieldError::Empty);
        }
        for number in points.iter().flat_map(|point| point.to_array()) {
            check::number(number.into(), &COORDINATE_M)?;
        }
        let corners = 0.0..=points.len() as f64 - 1.0;
        for corner in triangles.iter().flatten() {
            check::number(f64::from(*corner), &corners)?;
        }
        deviation_m.map_or(Ok(0.0), |deviation_m| check::number(deviation_m, &UNCERTAINTY_M))?;
        Ok(Self {
            points,
            triangles,
            deviation_m,
        })
    }

    /// Reads a glTF 2.0 file whose scene space is the world, by the rules of [`Toy::from_glb`]:
    /// nodes are in their authored pose. `file` names it in messages.
    ///
    /// # Errors
    /// As [`Toy::from_glb`], or a position that is out of range.
    pub fn from_glb(file: &str, bytes: &[u8], deviation_m: Option<f64>) -> Result<Self, PlaceMeshError> {
        let toy = Toy::from_glb(file, bytes)?;
        let mut posed = PosedMesh::default();
        toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed)?;
        let corners = toy.indices().chunks_exact(3);
        let triangles: Vec<[u32; 3]> = corners.map(|corner| [corner[0], corner[1], corner[2]]).collect();
        Ok(Self::new(posed.positions, triangles, deviation_m)?)
    }

    /// The mesh as a binary glTF file.
    #[must_use]
    pub fn to_glb(&self) -> Vec<u8> {
        const FLOAT: u32 = 5126;
        const UNSIGNED_INT: u32 = 5125;
        const TRIANGLES: u32 = 4;
        let least = self.points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let most = self.points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let points = self.points.iter().flat_map(|point| point.to_array());
        let mut data: Vec<u8> = points.flat_map(f32::to_le_bytes).collect();
        let n_point_bytes = data.len();
        data.extend(
            self.triangles
                .iter()
                .flatten()
                .flat_map(|corner| corner.to_le_bytes()),
        );
        let index = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "mode": TRIANGLES }] }],
            "buffers": [{ "byteLength": data.len() }],
            "bufferViews": [
                { "buffer": 0, "byteOffset": 0, "byteLength": n_point_bytes },
                { "buffer": 0, "byteOffset": n_point_bytes, "byteLength": data.len() - n_point_bytes },
            ],
            "accessors": [
                {
                    "bufferView": 0, "componentType": FLOAT, "count": self.points.len(), "type": "VEC3",
                    "min": least.to_array(), "max": most.to_array(),
                },
                { "bufferView": 1, "componentType": UNSIGNED_INT, "count": 3 * self.triangles.len(), "type": "SCALAR" },
            ],
        });
        binary_gltf(index.to_string().as_bytes(), &data)
    }

    /// Points in world space, in metres.
    #[must_use]
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Indices of the corners of each triangle, in either winding.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Standard deviation of a point in metres, if it is known.
    #[must_use]
    pub fn deviation_m(&self) -> Option<f64> {
        self.deviation_m
    }
}

/// The reason why a file of a mesh is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlaceMeshError {
    /// The file, or a number in it.
    #[error(transparent)]
    File(#[from] ToyError),
    /// The mesh that the file holds.
    #[error(transparent)]
    Mesh(#[from] FieldError),
}
