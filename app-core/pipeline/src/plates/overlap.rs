//! The choice of pairs of plates that are compared: their number grows with that of the plates, not
//! with its square.

use glam::UVec2;

use crate::geometry::anchored::AnchoredReceiver;
use crate::plates::shot::{Shot, shots_of};
use crate::plates::sight::PointOn;
use app_scene::disjoint::DisjointSets;
use app_scene::scene::Scene;

/// Points of a plate at which the others that show them are counted.
const N_POINTS: u32 = 144;
/// Step along the rows for a step down: every upright or level strip of a 144th of the picture
/// contains a point.
///
/// Source: Korobov 1959 (lattices of good points); in two dimensions neighbouring Fibonacci
/// numbers, Zaremba 1966.
const LATTICE_STEP: u32 = 89;
/// Number of plates with which each is compared, if that many overlap it: they close loops, in
/// which errors of pairs average out.
const N_NEIGHBOURS: usize = 4;

/// Two plates with common points.
struct Pair {
    /// Indices, the later one first.
    plates: [usize; 2],
    n_shared: usize,
    distance_m: f64,
}

/// For each plate the earlier ones with which it is compared.
///
/// The largest overlaps come first, and among equal ones the cameras that are closer together. A
/// pair is chosen if it connects plates that are not connected yet, or if one of the two has fewer
/// than [`N_NEIGHBOURS`]. Thus a few plates are all compared with each other, and many plates have
/// at most five pairs each.
pub(crate) fn compared(shots: &[Shot<'_>]) -> Vec<Vec<usize>> {
    let mut pairs = overlapping_pairs(shots);
    pairs.sort_by(|a, b| {
        let by_overlap = b.n_shared.cmp(&a.n_shared);
        by_overlap.then(a.distance_m.total_cmp(&b.distance_m))
    });
    let mut earlier_of = vec![Vec::new(); shots.len()];
    let mut n_neighbours = vec![0; shots.len()];
    let mut connected = DisjointSets::new(shots.len());
    for Pair { plates, .. } in pairs {
        let [a, b] = plates;
        let is_connected = connected.first(a) == connected.first(b);
        if is_connected && plates.iter().all(|plate| n_neighbours[*plate] >= N_NEIGHBOURS) {
            continue;
        }
        connected.join(a, b);
        plates.iter().for_each(|plate| n_neighbours[*plate] += 1);
        earlier_of[a].push(b);
    }
    earlier_of.iter_mut().for_each(|earlier| earlier.sort_unstable());
    earlier_of
}

/// The same for a scene.
#[must_use]
pub fn compared_plates(scene: &Scene, receivers: &[AnchoredReceiver]) -> Vec<Vec<usize>> {
    compared(&shots_of(scene, receivers))
}

fn overlapping_pairs(shots: &[Shot<'_>]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (later, shot) in shots.iter().enumerate() {
        let points = usable_points(shot);
        for (earlier, other) in shots[..later].iter().enumerate() {
            let is_shared =
                |point: &&PointOn| other.image_px_of(**point).is_some_and(|px| other.is_usable(px));
            let n_shared = points.iter().filter(is_shared).count();
            if n_shared > 0 {
                pairs.push(Pair {
                    plates: [later, earlier],
                    n_shared,
                    distance_m: shot.camera_in_world.distance(other.camera_in_world),
                });
            }
        }
    }
    pairs
}

/// Points of receivers on a lattice over a picture.
fn usable_points(shot: &Shot<'_>) -> Vec<PointOn> {
    let spacing = shot.size_px() / f64::from(N_POINTS);
    let places = (0..N_POINTS).map(|k| UVec2::new(k, k * LATTICE_STEP % N_POINTS));
    let pixels = places.map(|at| (at.as_dvec2() + 0.5) * spacing);
    pixels
        .filter(|px| shot.is_usable(*px))
        .filter_map(|px| shot.nearest(px))
        .collect()
}
