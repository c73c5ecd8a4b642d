//! Welds equal vertices of faceted triangles, which have their own otherwise, so that triangles are
//! divided together.

use std::collections::HashMap;

use crate::toy::geometry::{Geometry, place_bits};

/// Corners of triangles, with equal vertices of faceted triangles welded.
pub(super) fn welded(geometry: &Geometry) -> Vec<[u32; 3]> {
    if geometry.normals.is_some() || geometry.targets.iter().any(|target| target.moves()) {
        return geometry.triangles().to_vec();
    }
    let mut known = HashMap::new();
    let mut first = |vertex: u32| {
        let v = vertex as usize;
        let mut key = place_bits(geometry.positions[v]).to_vec();
        let uv = geometry.uvs.iter().flat_map(|uvs| uvs[v].to_array());
        let color = geometry.colors.iter().flat_map(|colors| colors[v].to_array());
        key.extend(uv.chain(color).map(f32::to_bits));
        let influences = geometry.influences.iter().flat_map(|all| all.of(v));
        key.extend(influences.flat_map(|(joint, weight)| [u32::from(joint), weight.to_bits()]));
        *known.entry(key).or_insert(vertex)
    };
    let triangles = geometry.triangles().iter();
    triangles.map(|corners| corners.map(&mut first)).collect()
}
