//! A geometry with additional vertices: all attributes of a new vertex are interpolated between
//! two.

use std::ops::{Add, Mul};

use super::refine::{Made, Mesh};
use crate::toy::geometry::Geometry;
use crate::toy::skin::Influences;
use crate::toy::topology::{compacted, unwelded};

/// The geometry with a mesh's triangles.
pub(super) fn geometry(own: &Geometry, mesh: &Mesh) -> Geometry {
    let triangles = mesh.triangles.as_flattened();
    let n_vertices = own.positions.len() + mesh.made.len();
    // Without normals, every triangle has three vertices of its own.
    let corners = match own.normals {
        Some(_) => compacted(triangles, n_vertices),
        None => unwelded(triangles.to_vec()),
    };
    let maker = Maker {
        made: &mesh.made,
        sources: &corners.sources,
    };
    Geometry {
        positions: maker.values(&own.positions),
        normals: own.normals.as_ref().map(|normals| maker.values(normals)),
        targets: own
            .targets
            .iter()
            .map(|target| target.mapped(|values| maker.values(values)))
            .collect(),
        influences: own
            .influences
            .as_ref()
            .map(|influences| maker.influences(influences)),
        uvs: own.uvs.as_ref().map(|uvs| maker.values(uvs)),
        colors: own.colors.as_ref().map(|colors| maker.values(colors)),
        indices: corners.indices,
    }
}

struct Maker<'a> {
    made: &'a [Made],
    /// The vertices to keep.
    sources: &'a [u32],
}

impl Maker<'_> {
    fn values<T>(&self, own: &[T]) -> Vec<T>
    where
        T: Copy + Add<Output = T> + Mul<f32, Output = T>,
    {
        let mut all = own.to_vec();
        for made in self.made {
            let (from, to) = (all[made.from as usize], all[made.to as usize]);
            all.push(from * (1.0 - made.part) + to * made.part);
        }
        self.sources.iter().map(|&source| all[source as usize]).collect()
    }

    /// The joints of both ends; the ones of largest weight if there are too many for a vertex.
    fn influences(&self, own: &Influences) -> Influences {
        let n = own.n_per_vertex;
        let mut all = own.clone();
        for made in self.made {
            let mut joints: Vec<(u16, f32)> = Vec::with_capacity(2 * n);
            for (end, part) in [(made.from, 1.0 - made.part), (made.to, made.part)] {
                let ends: Vec<(u16, f32)> =
                    all.of(end as usize).filter(|(_, weight)| *weight > 0.0).collect();
                for (joint, weight) in ends {
                    match joints.iter_mut().find(|(known, _)| *known == joint) {
                        Some((_, sum)) => *sum += part * weight,
                        None => joints.push((joint, part * weight)),
                    }
                }
            }
            joints.sort_by(|one, other| other.1.total_cmp(&one.1));
            joints.truncate(n);
            let sum: f32 = joints.iter().map(|(_, weight)| weight).sum();
            joints.resize(n, (0, 0.0));
            all.joints.extend(joints.iter().map(|(joint, _)| joint));
            all.weights.extend(joints.iter().map(|(_, weight)| weight / sum));
        }
        all.gather(self.sources)
    }
}
