//! Bounds of a toy over a whole clip for any camera or light: its farthest points by direction.

use glam::DVec3;

use app_scene::geometry::bounds::Bounds;
use app_scene::toy::PosedMesh;

/// Bins along each side of each of the six faces of the cube of directions.
const N_SIDE_BINS: usize = 8;
const N_BINS: usize = 6 * N_SIDE_BINS * N_SIDE_BINS;
/// Directions in which a bin keeps its farthest point: outwards, and at 45 degrees to that towards
/// each of four sides.
const N_KEPT: usize = 5;
/// Largest distance of dropped points beyond the kept ones, relative to their distance from the
/// centre: 1 - cos of half a bin's diagonal, rounded up.
const SLACK: f64 = 0.02;

/// Some hundred points whose convex hull contains all included points, except for 1/200 of the size
/// of thin, distant parts.
#[derive(Clone, Debug)]
pub struct Outline {
    middle: DVec3,
    /// Offsets from the centre to the farthest points of each bin; zero in an empty bin.
    farthest: Vec<[DVec3; N_KEPT]>,
}

impl Outline {
    /// Returns an empty outline; `middle` is a point in the toy.
    #[must_use]
    pub fn new(middle: DVec3) -> Self {
        Self {
            middle,
            farthest: vec![[DVec3::ZERO; N_KEPT]; N_BINS],
        }
    }

    /// The outline of all points of a pose.
    #[must_use]
    pub fn around(posed: &PosedMesh) -> Self {
        let mut outline = Self::new(Bounds::around(posed.points()).centre());
        posed.points().for_each(|point| outline.include(point));
        outline
    }

    /// Includes a point.
    pub fn include(&mut self, point: DVec3) {
        let offset = point - self.middle;
        let (slot, directions) = bin(offset);
        for (known, direction) in self.farthest[slot].iter_mut().zip(directions) {
            if offset.dot(direction) > known.dot(direction) {
                *known = offset;
            }
        }
    }

    /// Whether a point lies no farther out than the included ones, except for the slack.
    #[must_use]
    pub fn holds(&self, point: DVec3) -> bool {
        let offset = point - self.middle;
        let (slot, directions) = bin(offset);
        let mut known = self.farthest[slot].iter().zip(directions);
        known.all(|(known, direction)| offset.dot(direction) <= (1.0 + SLACK) * known.dot(direction))
    }

    /// The points of the outline.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let is_first =
            |kept: &[DVec3; N_KEPT], k: usize| kept[k] != DVec3::ZERO && !kept[..k].contains(&kept[k]);
        self.farthest.iter().flat_map(move |kept| {
            let new = (0..N_KEPT).filter(move |k| is_first(kept, *k));
            new.map(|k| self.middle + (1.0 + SLACK) * kept[k])
        })
    }
}

/// The bin of a direction, which is a square of a face of the cube, and the directions in which the
/// bin keeps points.
fn bin(offset: DVec3) -> (usize, [DVec3; N_KEPT]) {
    let axis = offset.abs().max_position();
    let along = offset[axis];
    if along == 0.0 {
        return (0, [DVec3::ZERO; N_KEPT]);
    }
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    #[allow(
        clippy::cast_possible_truncation,
        reason = "from 0 to a handful; what is not a number becomes 0"
    )]
    let cell =
        |at: f64| ((0.5 * (at / along.abs() + 1.0) * N_SIDE_BINS as f64) as usize).min(N_SIDE_BINS - 1);
    let middle = |cell: usize| (cell as f64 + 0.5) * 2.0 / N_SIDE_BINS as f64 - 1.0;
    let at = [cell(offset[u]), cell(offset[v])];
    let mut outwards = DVec3::ZERO;
    (outwards[axis], outwards[u], outwards[v]) = (along.signum(), middle(at[0]), middle(at[1]));
    let outwards = outwards.normalize();
    let (right, up) = outwards.any_orthonormal_pair();
    let face = 2 * axis + usize::from(along < 0.0);
    let directions = [DVec3::ZERO, right, -right, up, -up].map(|aside| outwards + aside);
    ((face * N_SIDE_BINS + at[0]) * N_SIDE_BINS + at[1], directions)
}
