//! The toy's triangles, grouped by material, for draws that show it.

use std::ops::Range;

use glam::Vec3;

use crate::gpu::{Draw, Group};
use crate::passes::materials::Materials;
use crate::passes::toy_mesh::corners::n;
use app_scene::toy::Toy;

/// Pipelines of one pass: for both sides of each triangle, and for the side that faces the camera
/// alone.
pub(crate) struct Sided<'a> {
    pub(crate) both: &'a Draw,
    pub(crate) culled: &'a Draw,
    pub(crate) groups: &'a [Group],
    /// Position of the camera.
    pub(crate) camera_in_anchor: Vec3,
}

/// A run of indices with one material.
pub(super) struct Run {
    /// Indices of closed pieces.
    pub(super) closed: Range<u32>,
    /// Indices of open pieces, which follow.
    pub(super) open: Range<u32>,
    /// Index of the material, which the shaders get from the instance.
    pub(super) material: u32,
    /// Index of its look.
    pub(super) look: usize,
}

/// The draws of a toy and its corners; successive draws with the same material are merged, and
/// within each draw the closed pieces come first.
pub(super) fn runs(toy: &Toy, materials: &Materials) -> (Vec<Run>, Vec<u32>) {
    let mut alike: Vec<(Range<usize>, usize)> = Vec::new();
    for part in toy.parts() {
        let [start, end] = [part.indices.start, part.indices.end].map(|index| index as usize);
        match alike.last_mut() {
            Some((last, material)) if *material == part.material && last.end == start => last.end = end,
            _ => alike.push((start..end, part.material)),
        }
    }
    let (mut runs, mut indices) = (Vec::new(), Vec::new());
    for (range, material) in alike {
        let Some(look) = materials.look(material) else {
            continue;
        };
        let [closed, open] = [true, false].map(|is_closed| {
            let first = n(&indices);
            indices.extend(corners_of(toy, range.clone(), is_closed));
            first..n(&indices)
        });
        runs.push(Run {
            closed,
            open,
            // Materials are counted when they are read.
            material: u32::try_from(material).unwrap_or(u32::MAX),
            look,
        });
    }
    (runs, indices)
}

/// Corners of those triangles in a range of the toy's that belong to closed pieces, or to open
/// ones.
fn corners_of(toy: &Toy, range: Range<usize>, is_closed: bool) -> impl Iterator<Item = u32> {
    let closed = &toy.shadow_indices().is_of_closed;
    let triangles = toy.indices().as_chunks::<3>().0.iter().zip(closed);
    triangles
        .skip(range.start / 3)
        .take(range.len() / 3)
        .filter(move |(_, is_of_closed)| **is_of_closed == is_closed)
        .flat_map(|(corners, _)| *corners)
}
