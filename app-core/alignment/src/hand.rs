//! The rotation between two hand-held photographs of one place: corners of one are matched in the
//! other by their neighbourhoods, and most of them agree on one rotation.
//!
//! Some centimetres between the cameras also cause parallax, which the direct alignment of the
//! table corrects afterwards.
//!
//! Source: corners by Shi and Tomasi 1994, normalized cross-correlation, consensus by Fischler and
//! Bolles 1981.

use glam::{DMat3, DQuat, DVec3, IVec2};

use crate::picture::{Level, index_in, places};
use app_scene::scene::Intrinsics;

/// Side of the cells with one corner each, in pixels.
const CELL_PX: i32 = 16;
/// Half the side of a corner's neighbourhood, in pixels.
const HALF_PX: i32 = 6;
/// Search range of a corner, over the picture's width.
const REACH: f64 = 0.14;
/// Correlation of a match.
const LEAST_CORRELATION: f32 = 0.75;
/// Number of places kept for each corner, since tiles look like their neighbours, and the least
/// distance between two, in pixels.
const N_PLACES: usize = 4;
const APART_PX: i32 = 4;
/// Largest deviation of a corner from a rotation it agrees with, over the picture's width: parallax
/// causes as much.
const AGREE: f64 = 0.012;
/// Required number of agreeing corners, and their fraction of all matches.
const LEAST_AGREEING: usize = 12;
const LEAST_PART: f64 = 0.3;
/// Largest relative difference between the distances of two corners in plate and photograph.
const MOST_STRETCH: f64 = 0.1;
/// Largest rotation by hand between two photographs of one view, in radians.
const MOST_TURN_RAD: f64 = 0.2;
/// Rotations with this fraction of the largest number of agreeing corners count as equally good.
const SAME: f64 = 0.95;
/// If no rotation explains this fraction of the best one's corners, the camera stood still.
const STOOD: f64 = 0.9;

/// Brightness of a picture, rows from the top.
struct Gray {
    size_px: IVec2,
    values: Vec<f32>,
}

/// A corner of the photograph, and its matches in the plate, the best first; as directions in the
/// cameras' spaces.
struct Match {
    of_photograph: DVec3,
    of_plate: Vec<DVec3>,
}

/// Rotation from the plate's camera to the photograph's; `None` if it is zero, or the pictures do
/// not constrain it.
pub(crate) fn photograph_from_plate(level: &Level) -> Option<DQuat> {
    let plate = level.plate.as_ref()?;
    let [photograph, plate] = [&level.frame, plate].map(|picture| Gray {
        size_px: picture.size_px,
        values: places(picture.size_px)
            .map(|at| {
                picture
                    .get(at)
                    .map_or(f32::NAN, |[r, g, b]| (r + g + b).max(0.0).sqrt())
            })
            .collect(),
    });
    let patches = Patches::of(&plate);
    let matches: Vec<Match> = photograph
        .corners()
        .into_iter()
        .filter_map(|corner| {
            let found = patches.find(photograph.patch(corner)?, corner);
            (!found.is_empty()).then(|| Match {
                of_photograph: ray(&level.intrinsics, corner),
                of_plate: found.into_iter().map(|at| ray(&level.intrinsics, at)).collect(),
            })
        })
        .collect();
    let most_rad = AGREE * f64::from(level.frame.size_px.x) / level.intrinsics.fx_px;
    let n_agreeing = |rotation: &DQuat| {
        let agrees = |one: &&Match| {
            let mut places = one.of_plate.iter();
            places.any(|of_plate| (*rotation * *of_plate).distance(one.of_photograph) < most_rad)
        };
        matches.iter().filter(agrees).count()
    };
    let rotations = hypotheses(&matches)
        .into_iter()
        .map(|rotation| (n_agreeing(&rotation), rotation));
    let rotations: Vec<(usize, DQuat)> = rotations.collect();
    let n_best = rotations.iter().map(|(n, _)| *n).max()?;
    let is_best = |n: usize| n as f64 >= SAME * n_best as f64;
    // On a repeating pattern the smallest rotation is the most likely.
    let best = rotations.into_iter().filter(|(n, _)| is_best(*n));
    let (_, best) = best.min_by(|(_, a), (_, b)| angle(a).total_cmp(&angle(b)))?;
    let is_clear = n_best >= LEAST_AGREEING && n_best as f64 >= LEAST_PART * matches.len() as f64;
    let stood = n_agreeing(&DQuat::IDENTITY) as f64 >= STOOD * n_best as f64;
    (is_clear && !stood).then_some(best)
}

fn angle(rotation: &DQuat) -> f64 {
    rotation.to_scaled_axis().length()
}

/// Rotations from pairs of corners, for each corner with some others.
fn hypotheses(matches: &[Match]) -> Vec<DQuat> {
    let n = matches.len();
    let mut rotations = Vec::new();
    for a in 0..n {
        // Distant in the list, and so distant in the picture.
        for b in [1, 3, 5].map(|part| (a + part * n / 7) % n) {
            for of_a in &matches[a].of_plate {
                for of_b in &matches[b].of_plate {
                    let of_photograph = [&matches[a], &matches[b]].map(|one| one.of_photograph);
                    let rotation = rotation_of(of_photograph, [*of_a, *of_b]);
                    rotations.extend(rotation.filter(|rotation| angle(rotation) < MOST_TURN_RAD));
                }
            }
        }
    }
    rotations
}

fn ray(k: &Intrinsics, at: IVec2) -> DVec3 {
    k.ray(at.as_dvec2() + 0.5).normalize()
}

/// The rotation from the second pair of directions to the first; `None` if the directions of a pair
/// are too close to one another, or the pairs' angles differ.
fn rotation_of(photograph: [DVec3; 2], plate: [DVec3; 2]) -> Option<DQuat> {
    let [apart, of_plate] = [photograph, plate].map(|[a, b]| a.angle_between(b));
    if (apart - of_plate).abs() > MOST_STRETCH * apart {
        return None;
    }
    let frame = |[a, b]: [DVec3; 2]| {
        let x = (a + b).try_normalize()?;
        let z = a.cross(b).try_normalize()?;
        Some(DMat3::from_cols(x, z.cross(x), z))
    };
    Some(DQuat::from_mat3(
        &(frame(photograph)? * frame(plate)?.transpose()),
    ))
}

impl Gray {
    fn at(&self, at: IVec2) -> f32 {
        index_in(self.size_px, at).map_or(f32::NAN, |index| self.values[index])
    }

    /// The strongest corner of each cell.
    fn corners(&self) -> Vec<IVec2> {
        let cells = places(self.size_px / CELL_PX);
        let corners = cells.filter_map(|cell| {
            let places = places(IVec2::splat(CELL_PX / 2)).map(|at| CELL_PX * cell + 2 * at);
            let best = places
                .map(|at| (self.cornerness(at), at))
                .filter(|(cornerness, _)| cornerness.is_finite())
                .max_by(|(a, _), (b, _)| a.total_cmp(b))?;
            (best.0 > 0.0).then_some(best.1)
        });
        corners.collect()
    }

    /// The smaller eigenvalue of the gradients' covariance around a place; NaN near the border.
    fn cornerness(&self, at: IVec2) -> f32 {
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for step in places(IVec2::splat(HALF_PX)) {
            let at = at + 2 * step - HALF_PX;
            let x = self.at(at + IVec2::X) - self.at(at - IVec2::X);
            let y = self.at(at + IVec2::Y) - self.at(at - IVec2::Y);
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        }
        0.5 * (xx + yy - ((xx - yy).powi(2) + 4.0 * xy * xy).sqrt())
    }

    /// Every other pixel around a place, minus the mean and of unit length; `None` near the border,
    /// or without contrast.
    fn patch(&self, place: IVec2) -> Option<Patch> {
        let mut patch = [0.0; 49];
        for (value, step) in patch.iter_mut().zip(places(IVec2::splat(HALF_PX + 1))) {
            *value = self.at(place + 2 * step - HALF_PX);
        }
        let mean = patch.iter().sum::<f32>() / 49.0;
        let length = patch
            .iter()
            .map(|value| (value - mean).powi(2))
            .sum::<f32>()
            .sqrt();
        (length.is_finite() && length > 0.0).then(|| patch.map(|value| (value - mean) / length))
    }
}

/// A neighbourhood of a place.
type Patch = [f32; 49];

/// The neighbourhoods of all places of a picture.
struct Patches {
    size_px: IVec2,
    patches: Vec<Option<Patch>>,
}

impl Patches {
    fn of(gray: &Gray) -> Self {
        let patches = places(gray.size_px).map(|place| gray.patch(place));
        Self {
            size_px: gray.size_px,
            patches: patches.collect(),
        }
    }

    /// Matches of a place's neighbourhood in another picture, the best first.
    fn find(&self, template: Patch, place: IVec2) -> Vec<IVec2> {
        #[allow(clippy::cast_possible_truncation, reason = "pixels")]
        let reach_px = (REACH * f64::from(self.size_px.x)) as i32;
        let around = places(IVec2::splat(2 * reach_px + 1)).map(|step| place + step - reach_px);
        let mut like: Vec<(f32, IVec2)> = around
            .filter_map(|at| {
                let patch = self.patches[index_in(self.size_px, at)?]?;
                let correlation: f32 = patch.iter().zip(&template).map(|(a, b)| a * b).sum();
                (correlation >= LEAST_CORRELATION).then_some((correlation, at))
            })
            .collect();
        like.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let mut found: Vec<IVec2> = Vec::new();
        for (_, at) in like {
            let is_new = |known: &IVec2| (*known - at).abs().max_element() >= APART_PX;
            if found.iter().all(is_new) {
                found.push(at);
            }
            if found.len() == N_PLACES {
                break;
            }
        }
        found
    }
}
