//! Levels of detail of the shadow-casting mesh.
//!
//! A shadow needs no finer shape than its map has pixels, and most of a frame's triangles are drawn
//! for shadows: the toy is drawn once for each point of a light and each direction of ambient
//! light. So the shape is simplified once, and each pass uses the coarsest level that is accurate
//! enough.

use std::ops::RangeInclusive;

use glam::{DMat4, Vec3};

use super::Toy;
use super::moment::Pose;
use super::pose::PosedMesh;
use super::simplify::{Collapse, collapses};

/// Moments of each clip that count besides the authored pose, as fractions of its duration: the
/// first of all clips, then the next.
const MOMENTS: [f64; 5] = [0.5, 0.0, 1.0, 0.25, 0.75];
/// Number of poses, fewer for toys with many triangles: simplification takes about a second for
/// 200,000 triangles in all poses.
const N_POSES: RangeInclusive<usize> = 3..=16;
/// Largest number of triangles over all poses, if more than the least number of poses is used.
const MOST_POSED_TRIANGLES: usize = 500_000;
/// Largest error of a level, as a fraction of the toy's radius.
const MOST_ERROR: f64 = 0.05;
/// Levels with fewer triangles gain nothing.
const LEAST_TRIANGLES: usize = 64;
/// Ratio of triangles between a level and the next finer one.
const STEP: f64 = 0.7;

/// A level of detail.
#[derive(Clone, Debug, PartialEq)]
pub struct Caster {
    /// Its geometric error, in units of the file.
    pub error: f64,
    /// Corners of triangles, as in [`super::ShadowIndices`].
    pub indices: Vec<u32>,
    /// Number of corners of closed pieces, which come first.
    pub n_closed: usize,
}

impl Toy {
    /// Levels with fewer triangles than [`Toy::shadow_indices`], finest first. Computed at the
    /// first call.
    pub fn casters(&self) -> &[Caster] {
        self.casters.get_or_init(|| casters(self))
    }
}

fn casters(toy: &Toy) -> Vec<Caster> {
    let shape = toy.shadow_indices();
    let triangles = shape.indices.as_chunks::<3>().0;
    let n_poses = MOST_POSED_TRIANGLES / triangles.len().max(1);
    let poses = poses(toy, n_poses.clamp(*N_POSES.start(), *N_POSES.end()));
    let Some(radius) = poses.first().map(|places| radius(triangles, places)) else {
        return Vec::new();
    };
    let made = collapses(triangles, &poses, (MOST_ERROR * radius, LEAST_TRIANGLES));
    let mut levels = Vec::new();
    let mut n_before = triangles.len();
    let mut moved: Vec<u32> = (0..).take(toy.n_vertices()).collect();
    for (index, collapse) in made.iter().enumerate() {
        moved[collapse.from as usize] = collapse.to;
        let is_step = fewer(n_before) >= collapse.n_left;
        // All collapses of equal error belong to one level.
        let is_whole = made.get(index + 1).is_none_or(|next| next.error > collapse.error);
        if is_step && is_whole {
            levels.push(caster(triangles, shape.n_closed, &mut moved, collapse));
            n_before = collapse.n_left;
        }
    }
    levels
}

#[expect(clippy::cast_possible_truncation, reason = "a part of a number of triangles")]
fn fewer(n_triangles: usize) -> usize {
    (STEP * n_triangles as f64) as usize
}

fn caster(triangles: &[[u32; 3]], n_closed: usize, moved: &mut [u32], collapse: &Collapse) -> Caster {
    let mut place_of = |corner: u32| {
        let mut at = corner;
        while moved[at as usize] != at {
            // Follow chains of moves, so that each vertex points to its final place.
            moved[at as usize] = moved[moved[at as usize] as usize];
            at = moved[at as usize];
        }
        at
    };
    let mut left_of = |triangles: &[[u32; 3]]| -> Vec<u32> {
        let corners = triangles.iter().map(|corners| corners.map(&mut place_of));
        let left = corners.filter(|[a, b, c]| a != b && b != c && c != a);
        left.flatten().collect()
    };
    let (closed, open) = triangles.split_at(n_closed / 3);
    let (closed, open) = (left_of(closed), left_of(open));
    Caster {
        error: collapse.error,
        n_closed: closed.len(),
        indices: [closed, open].concat(),
    }
}

/// Positions in the authored pose, and at moments of clips.
fn poses(toy: &Toy, n_poses: usize) -> Vec<Vec<Vec3>> {
    let of_clips = MOMENTS.into_iter().flat_map(|part| {
        toy.clip_ids().map(move |clip| Pose::Clip {
            clip,
            time_secs: part * toy.clips()[clip.index()].duration_secs,
        })
    });
    let poses = std::iter::once(Pose::Authored).chain(of_clips).take(n_poses);
    let places = poses.filter_map(|pose| {
        let mut posed = PosedMesh::default();
        toy.pose(&pose, &DMat4::IDENTITY, &mut posed).ok()?;
        Some(posed.positions)
    });
    places.collect()
}

/// Radius of the sphere around the corners' box.
fn radius(triangles: &[[u32; 3]], places: &[Vec3]) -> f64 {
    let corners = || triangles.iter().flatten().map(|corner| places[*corner as usize]);
    let least = corners().fold(Vec3::INFINITY, Vec3::min);
    let most = corners().fold(Vec3::NEG_INFINITY, Vec3::max);
    0.5 * (most - least).as_dvec3().length()
}
