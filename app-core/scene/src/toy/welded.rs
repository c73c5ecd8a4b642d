//! The welded vertices of a toy, and its faces with their edges: what its outline depends on besides the pose.

use std::sync::Arc;

use super::Toy;
use super::shadow_indices::ShadowIndices;
use crate::geometry::edges::Faces;

/// Welded vertices and their faces.
#[derive(Debug)]
pub struct Welded {
    /// The toy's vertex of each of them, in ascending order.
    pub vertices: Vec<u32>,
    /// Faces of which those facing an eye cover the whole toy; corners are places in `vertices`.
    pub faces: Arc<Faces>,
}

impl Welded {
    fn of(shadow: &ShadowIndices) -> Self {
        let mut vertices = shadow.indices.clone();
        vertices.sort_unstable();
        vertices.dedup();
        let mut places = vec![0; vertices.last().map_or(0, |last| *last as usize + 1)];
        for (place, vertex) in (0..).zip(&vertices) {
            places[*vertex as usize] = place;
        }
        let triangles = shadow.facing_anywhere();
        let triangles = triangles.map(|corners| corners.map(|vertex| places[vertex as usize]));
        Self {
            faces: Arc::new(Faces::new(triangles.collect())),
            vertices,
        }
    }
}

impl Toy {
    /// Its welded vertices and their faces: the same in every pose, and of every displaced copy.
    #[must_use]
    pub fn welded(&self) -> &Welded {
        self.welded.get_or_init(|| Welded::of(&self.shadow_indices))
    }
}
