//! Converts lists, strips and fans to plain triangles, and selects their vertices.

use gltf::json::mesh::Mode;

/// Triangles as a flat list of corners; `None` for points and lines.
///
/// Triangles with a repeated corner, which connect strips, are dropped. Source: glTF 2.0
/// specification, 3.7.2.1 (topology types).
pub(super) fn triangles(mode: Mode, corners: &[u32]) -> Option<Vec<u32>> {
    let windows = || corners.windows(3).enumerate();
    let triangles: Vec<[u32; 3]> = match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return None,
        Mode::Triangles => corners.as_chunks().0.to_vec(),
        Mode::TriangleStrip => windows()
            .map(|(i, w)| {
                if i % 2 == 0 {
                    [w[0], w[1], w[2]]
                } else {
                    [w[0], w[2], w[1]]
                }
            })
            .collect(),
        Mode::TriangleFan => windows().map(|(_, w)| [w[1], w[2], corners[0]]).collect(),
    };
    let is_proper = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    Some(triangles.into_iter().filter(is_proper).flatten().collect())
}

/// Vertices to keep, and triangles that refer to them.
pub(super) struct Corners {
    /// For each kept vertex, its source.
    pub(super) sources: Vec<u32>,
    /// Corners of the triangles, as indices of kept vertices.
    pub(super) indices: Vec<u32>,
}

/// Gives each triangle three vertices of its own, as faceted shading needs.
pub(super) fn unwelded(triangles: Vec<u32>) -> Corners {
    Corners {
        indices: (0..).take(triangles.len()).collect(),
        sources: triangles,
    }
}

/// Keeps the vertices that triangles use, in their order. All corners are below `n_vertices`.
pub(super) fn compacted(triangles: &[u32], n_vertices: usize) -> Corners {
    const UNUSED: u32 = u32::MAX;
    let mut kept = vec![UNUSED; n_vertices];
    for &corner in triangles {
        kept[corner as usize] = 0;
    }
    let mut sources = Vec::new();
    for (source, kept) in (0..).zip(&mut kept).filter(|(_, kept)| **kept != UNUSED) {
        *kept = u32::try_from(sources.len()).unwrap_or(UNUSED);
        sources.push(source);
    }
    Corners {
        indices: triangles.iter().map(|&corner| kept[corner as usize]).collect(),
        sources,
    }
}
