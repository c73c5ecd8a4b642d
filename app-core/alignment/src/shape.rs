//! The physical toy as a shape in camera space.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::picture::Level;
use app_scene::geometry::bounds::Bounds;
use app_scene::geometry::edges::Faces;
use app_scene::scene::Scene;
use app_scene::toy::{PosedMesh, ToyError};

/// Welded vertices, and triangles of which those facing an eye cover the whole toy.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Points in camera space.
    pub(super) points: Vec<DVec3>,
    /// Faces of these points.
    pub(super) faces: Arc<Faces>,
    /// Centre of the box around it.
    pub(super) centre: DVec3,
    /// Half of that box's diagonal, in metres.
    pub(super) radius_m: f64,
}

impl Shape {
    /// The shape in the scene's physical pose.
    pub(super) fn new(scene: &Scene, camera_from_object: &DMat4) -> Result<Self, ToyError> {
        let toy = &scene.toy;
        let mut posed = PosedMesh::default();
        toy.pose(&scene.physical_pose, camera_from_object, &mut posed)?;
        let welded = toy.welded();
        let points: Vec<DVec3> = welded
            .vertices
            .iter()
            .map(|vertex| posed.positions[*vertex as usize].as_dvec3())
            .collect();
        let bounds = Bounds::around(points.iter().copied());
        Ok(Self {
            faces: Arc::clone(&welded.faces),
            centre: bounds.centre(),
            radius_m: 0.5 * (bounds.max - bounds.min).length(),
            points,
        })
    }

    /// The shape merged in cells whose side is in pixels of a level, at the distance of its centre.
    pub(super) fn merged_in_px(&self, cell_px: f64, level: &Level) -> Self {
        self.merged(cell_px * self.centre.length() / level.intrinsics.fx_px)
    }

    /// The shape with the vertices in each cell merged to their mean, and without collapsed
    /// triangles.
    ///
    /// Source: Rossignac and Borrel 1993.
    pub(super) fn merged(&self, cell_m: f64) -> Self {
        let mut cells: BTreeMap<[i64; 3], u32> = BTreeMap::new();
        let mut sums: Vec<(DVec3, f64)> = Vec::new();
        let places: Vec<u32> = self
            .points
            .iter()
            .map(|point| {
                let cell = ((*point - self.centre) / cell_m).floor().as_i64vec3().to_array();
                let next = sums.len();
                #[allow(clippy::cast_possible_truncation, reason = "no more than there are points")]
                let place = *cells.entry(cell).or_insert(next as u32);
                if place as usize == next {
                    sums.push((DVec3::ZERO, 0.0));
                }
                let (sum, n) = &mut sums[place as usize];
                *sum += *point;
                *n += 1.0;
                place
            })
            .collect();
        let merged = self
            .faces
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| places[corner as usize]));
        // Many become equal.
        let mut known = BTreeSet::new();
        let merged = merged.filter(|[a, b, c]| a != b && b != c && c != a);
        let merged = merged.filter(|[a, b, c]| {
            let least = *a.min(b).min(c);
            known.insert(if least == *a {
                [*a, *b, *c]
            } else if least == *b {
                [*b, *c, *a]
            } else {
                [*c, *a, *b]
            })
        });
        let faces = Arc::new(Faces::new(merged.collect()));
        Self {
            points: sums.into_iter().map(|(sum, n)| sum / n).collect(),
            faces,
            ..*self
        }
    }
}
