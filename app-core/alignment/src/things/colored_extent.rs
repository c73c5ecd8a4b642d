//! Extent of a plane whose colours are the place's, so that no thing grows to its edges: the
//! rectangle that has the colours of the pixels where the toy's shadow lies on the plane, or that of these pixels
//! alone if their colours do not tell the plane from the place.
//!
//! Source: Rother et al. 2004 (GrabCut: the colours inside and outside are learned in turn), with a
//! rectangle on the plane in place of a cut.

use glam::{DMat4, DVec2, DVec3, IVec2, Vec3Swizzles};

use super::codes::Codes;
use super::colors::Colors;
use super::extent::Extent;
use crate::picture::{Color, Level, index_in, places, square};
use crate::receivers::SeenReceiver;

/// Least pixels whose shadow shows that they are on the plane.
const LEAST_SHOWN: usize = 40;
/// Rounds of learning colours, and of moving opposite sides in turn. A third round of colours moves
/// no side of a checked book by a millimetre.
const N_ROUNDS: usize = 2;
const N_MOVES: usize = 4;
/// Number of finer trial angles on either side of the best.
const N_FINER: i32 = 10;
/// Largest log likelihood ratio of a pixel by its colour, and that of one whose shadow shows what it
/// is.
const MOST: f32 = 2.0;
const SHOWN: f32 = 4.0;
/// Log likelihood ratio below which a colour is the place's. With 0 and .25 a book of another colour
/// ends where it does in truth, and with .35 it does not: the thing's own growth is better bounded then,
/// and 6 mm too short.
const OF_PLACE: f32 = 0.25;
/// Least mean log likelihood ratio of the inner pixels by their colours: with less, these do not tell the
/// plane from the place. For a ramp of terrazzo on terrazzo it is .35, for a board of tiles on the same tiles .51,
/// for nine other boards, books and ramps .84 to 2.
const LEAST_TOLD: f32 = 0.43;
/// Distance in pixels up to which ratios are averaged: a pattern has colours of the place, too.
const AROUND_PX: i32 = 1;
/// Number of strips along the distance that a thing may reach, among which the sides are chosen: each is
/// a fraction of a pixel. With strips of half a millimetre the shadow's RMS error on three checked books
/// is 1.94, 1.75 and 2.59 codes, with these it is 1.90, 1.87 and 2.57.
const STRIPS_A_REACH: f64 = 600.0;

/// A pixel whose shadow shows whether it is on a plane.
pub(super) struct Evidence {
    pub(super) at: IVec2,
    pub(super) is_on_plane: bool,
    /// Whether the plane or a known receiver explains it.
    pub(super) is_explained: bool,
}

/// The picture around a thing: its pixels with their places on a plane.
pub(super) struct Surroundings<'a> {
    level: &'a Level,
    plane_from_camera: &'a DMat4,
    plate: Codes,
    /// Index and place of each pixel.
    near: Vec<(usize, DVec2)>,
    /// Their middle on the plane, and how far they reach from it, in metres.
    middle: DVec2,
    reach_m: f64,
}

impl<'a> Surroundings<'a> {
    /// Within a distance in metres from a point of the camera's space; `None` without a plate.
    pub(super) fn new(
        level: &'a Level,
        plane_from_camera: &'a DMat4,
        (middle, reach_m): (DVec3, f64),
    ) -> Option<Self> {
        let plate = Codes::of(level.plate.as_ref()?);
        let endless = SeenReceiver::of_size(*plane_from_camera, DVec2::INFINITY);
        let near = places(plate.size_px).zip(0..).filter_map(|(at, index)| {
            let point = endless.point_at(&level.intrinsics, at)?;
            let place = plane_from_camera.transform_point3(point).xz();
            (point.distance(middle) < reach_m).then_some((index, place))
        });
        Some(Self {
            level,
            plane_from_camera,
            near: near.collect(),
            plate,
            middle: plane_from_camera.transform_point3(middle).xz(),
            reach_m,
        })
    }

    /// The rectangle of the colours of those pixels that are on the plane, or of these pixels alone if their
    /// colours have no end, as those of stone on a table of the same stone; `None` if they are too few.
    pub(super) fn extent(&self, evidence: &[Evidence]) -> Option<Extent> {
        let mut is_inside = vec![false; self.plate.pixels.len()];
        for pixel in evidence.iter().filter(|pixel| pixel.is_on_plane) {
            if let Some(index) = index_in(self.plate.size_px, pixel.at) {
                is_inside[index] = true;
            }
        }
        let inside = self.near.iter().filter(|(index, _)| is_inside[*index]);
        let inside: Vec<DVec2> = inside.map(|(_, place)| *place).collect();
        if inside.len() < LEAST_SHOWN {
            return None;
        }
        let about = Extent::smallest(&inside)?;
        let explained = evidence.iter().filter(|pixel| pixel.is_explained);
        let by_color = self.of_colors(is_inside, &explained.collect::<Vec<_>>(), &about);
        // Where colours tell nothing, the sides below the plane, which nothing explains, show where it ends.
        by_color.or_else(|| {
            let evidence: Vec<&Evidence> = evidence.iter().collect();
            self.likeliest(&self.likelier(|_| -OF_PLACE, &evidence), &about)
        })
    }

    /// The rectangle of the colours of inner pixels, which it learns in turn; `None` if these
    /// do not tell it from the place, or have no end.
    fn of_colors(&self, mut is_inside: Vec<bool>, evidence: &[&Evidence], about: &Extent) -> Option<Extent> {
        let mut learned: Option<Extent> = None;
        for _ in 0..N_ROUNDS {
            let known = &is_inside;
            let of = |kind: bool| {
                let near = self.near.iter().filter(move |(index, _)| known[*index] == kind);
                near.map(|(index, _)| self.plate.pixels[*index])
            };
            let colors = Colors::of(of(true), of(false));
            let ratio = |color, of_place: f32| {
                let likelier = colors.likelier(color).unwrap_or(0.0);
                (likelier - of_place).clamp(-MOST, MOST)
            };
            let (sum, n) = of(true).fold((0.0, 0.0_f32), |(sum, n), color| {
                (sum + ratio(color, 0.0), n + 1.0)
            });
            if sum < LEAST_TOLD * n {
                return None;
            }
            let by_color = |color| ratio(color, OF_PLACE);
            let about = learned.as_ref().unwrap_or(about);
            let extent = self.likeliest(&self.likelier(by_color, evidence), about)?;
            let rectangle = extent.plane(self.plane_from_camera);
            for (at, is_inside) in places(self.plate.size_px).zip(&mut is_inside) {
                *is_inside = rectangle.point_at(&self.level.intrinsics, at).is_some();
            }
            learned = Some(extent);
        }
        learned.filter(|extent| extent.middle.distance(self.middle) + extent.half_m.length() < self.reach_m)
    }

    /// For each pixel, the log likelihood ratio that it shows what the inner ones show, by the colours of the
    /// pixels around it.
    fn likelier(&self, by_color: impl Fn(Color) -> f32, evidence: &[&Evidence]) -> Vec<f32> {
        let mut likelier: Vec<f32> = self.plate.pixels.iter().map(|color| by_color(*color)).collect();
        for pixel in evidence {
            if let Some(index) = index_in(self.plate.size_px, pixel.at) {
                likelier[index] = if pixel.is_on_plane { SHOWN } else { -SHOWN };
            }
        }
        let mean = |at: IVec2| {
            let around = || square(at, AROUND_PX).filter_map(|at| index_in(self.plate.size_px, at));
            around().map(|index| likelier[index]).sum::<f32>() / around().count().max(1) as f32
        };
        places(self.plate.size_px).map(mean).collect()
    }

    /// The likeliest rectangle near another one.
    fn likeliest(&self, likelier: &[f32], about: &Extent) -> Option<Extent> {
        let values = self.near.iter().map(|(index, place)| (*place, likelier[*index]));
        likeliest(&values.collect::<Vec<_>>(), self.reach_m / STRIPS_A_REACH, about)
    }
}

/// The rectangle of places with the largest sum of values, near another one. Its sides are on borders of
/// strips of `strip_m` metres.
fn likeliest(values: &[(DVec2, f32)], strip_m: f64, about: &Extent) -> Option<Extent> {
    let turned = |turn_rad| {
        let (sum, extent) = turned((values, strip_m), about, turn_rad);
        (-f64::from(sum), extent)
    };
    let (cost, extent) = Extent::of_least(N_FINER, turned)?;
    (cost < 0.0).then_some(extent)
}

/// The same with a given turn, and the sum.
fn turned((values, strip_m): (&[(DVec2, f32)], f64), about: &Extent, turn_rad: f64) -> (f32, Extent) {
    let axes = [DVec2::from_angle(turn_rad), DVec2::from_angle(turn_rad).perp()];
    let reach_m = 0.5 * about.half_m.length();
    let mut ends = axes.map(|axis| [-reach_m, reach_m].map(|by_m| about.middle.dot(axis) + by_m));
    let mut sum = 0.0;
    for _ in 0..N_MOVES {
        for along in 0..2 {
            let [low, high] = ends[1 - along];
            let band = values.iter().filter(|(place, _)| {
                let across = place.dot(axes[1 - along]);
                across >= low && across <= high
            });
            let band = band.map(|(place, value)| (place.dot(axes[along]), *value));
            (sum, ends[along]) = largest_sum(&band.collect::<Vec<_>>(), strip_m);
        }
    }
    let [low, high] = [0, 1].map(|end| DVec2::new(ends[0][end], ends[1][end]));
    let extent = Extent {
        middle: axes[0].rotate(0.5 * (low + high)),
        turn_rad,
        half_m: 0.5 * (high - low),
    };
    (sum, extent)
}

/// The interval with the largest sum of values at places on a line, and that sum. Source: Kadane's
/// algorithm (Bentley 1984), on strips.
fn largest_sum(values: &[(f64, f32)], strip_m: f64) -> (f32, [f64; 2]) {
    let first_m = values.iter().map(|(at, _)| *at).fold(f64::INFINITY, f64::min);
    let mut strips: Vec<f32> = Vec::new();
    for (at, value) in values {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of strips from the first"
        )]
        let strip = ((at - first_m) / strip_m) as usize;
        strips.resize(strips.len().max(strip + 1), 0.0);
        strips[strip] += value;
    }
    let (mut largest, mut interval) = (0.0, [0, 0]);
    let (mut sum, mut first) = (0.0_f32, 0);
    for (strip, value) in strips.into_iter().enumerate() {
        if sum <= 0.0 {
            (sum, first) = (0.0, strip);
        }
        sum += value;
        if sum > largest {
            (largest, interval) = (sum, [first, strip + 1]);
        }
    }
    (largest, interval.map(|strip| first_m + strip as f64 * strip_m))
}
