//! Initial guesses of an upright toy's place in a picture, for given viewing directions, if no pose
//! is known.
//!
//! A silhouette in the right place has the toy's colours within it, and beside it the plate, lit or
//! in shadow. So the colours within and the ratios to the plate beside it each fill as few bins of
//! a histogram as possible: the sum of both entropies is least there. No colour of the model is
//! needed, and no threshold separates toy and shadow.
//!
//! Source: region-based pose estimation (Rosenhahn et al. 2007; Prisacariu and Reid 2012, PWP3D),
//! with the ratio to the plate in place of the background's colours.

use std::collections::BTreeMap;

use glam::{DMat4, DQuat, DVec2, DVec3, IVec2};

use super::odds::logarithms;
use crate::median::median;
use crate::picture::{Color, Level, index_in, places};
use crate::raster::{Rasterizer, project};
use crate::shape::Shape;
use app_scene::scene::Intrinsics;

/// Width of a bin of colours, in natural logarithms of light.
const BIN: f32 = 0.25;
/// Fraction of all pixels that may have any colour, and its number of bins.
const ANY_COLOR: f64 = 0.02;
const N_LIKELY_BINS: f64 = 500.0;
/// Distance of a changed pixel's ratio to the plate from the median, in natural logarithms, in any
/// channel.
const CHANGED: f32 = 0.12;
/// Sizes of the toy's silhouette over the changed area, which is toy and shadow.
const SHARES: [f64; 7] = [0.95, 0.8, 0.66, 0.55, 0.45, 0.36, 0.28];
/// Sizes over the picture's if there is no plate.
const SHARES_OF_PICTURE: [f64; 7] = [0.3, 0.2, 0.14, 0.1, 0.07, 0.05, 0.035];
/// Smallest fraction of a silhouette's pixels inside the picture.
const LEAST_INSIDE: f64 = 0.8;
/// Largest number of pixels of the tiny level for guesses.
pub(crate) const TINY_PIXELS: i32 = 7000;
/// Distance of the places to try, in pixels.
const STRIDE_PX: i32 = 2;
/// Margin around the changed area, over the square root of that area.
const MARGIN: f64 = 0.35;
/// Number of moves of a standing toy to its best place.
const N_STANDING: usize = 4;
/// Reach of a tap around the rectangle of a silhouette, over the sides of that rectangle: a finger
/// is no pointer.
const BESIDE: f64 = 0.25;
/// Smallest sine of the angle between a line of sight and a plane: 3 degrees.
const LEAST_SLOPE: f64 = 0.052;

/// A direction from which an upright toy is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewDirection {
    /// Turn of the toy about its upright axis, in radians: at 0 the model's +Z points to the camera, at a quarter turn to the right of
    /// the picture.
    pub turn_rad: f64,
    /// Angle of the camera above the toy's horizon, in radians.
    pub elevation_rad: f64,
}

impl ViewDirection {
    /// Rotation from an upright toy's space to that of a camera which looks at it.
    fn camera_from_upright(self) -> DQuat {
        DQuat::from_rotation_x(self.elevation_rad) * DQuat::from_rotation_y(self.turn_rad)
    }
}

/// A place of the toy, with the cost of its silhouette.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guess {
    /// Transform from the space of the given shape.
    pub(crate) camera_from_upright: DMat4,
    /// Mean entropy of a pixel, in nats.
    pub(crate) cost: f64,
}

/// The best place for each direction, the best first. The shape is upright, its centre at
/// `shape.centre`.
pub(crate) fn guesses(shape: &Shape, level: &Level, directions: &[ViewDirection]) -> Vec<Guess> {
    let regions = Regions::new(level);
    let guesses = directions
        .iter()
        .filter_map(|direction| regions.best(shape, *direction));
    let mut guesses: Vec<Guess> = guesses.collect();
    guesses.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    guesses
}

/// The plane of a standing toy's centre, in camera space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    /// A point of the plane.
    pub(crate) point: DVec3,
    /// Unit normal.
    pub(crate) normal: DVec3,
}

/// The best place for each turn of a toy that stands on a plane, best first. The shape is upright,
/// in camera space; the turns are about the plane's normal, in radians. The plane fixes the toy's
/// distance, and with it its size. If a pixel was tapped, all places are at that pixel; otherwise
/// they are where the picture differs from its plate.
pub(crate) fn standing_guesses(
    shape: &Shape,
    level: &Level,
    (standing, turns_rad): (Standing, &[f64]),
    tapped_px: Option<DVec2>,
) -> Vec<Guess> {
    let regions = match tapped_px {
        Some(tapped_px) => Regions::tapped(level, tapped_px),
        None => Regions::new(level),
    };
    let guesses = turns_rad
        .iter()
        .filter_map(|turn_rad| regions.best_standing(shape, (standing, *turn_rad)));
    let mut guesses: Vec<Guess> = guesses.collect();
    guesses.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    guesses
}

/// The pixels of a level, each with its bins.
struct Regions<'a> {
    k: &'a Intrinsics,
    size_px: IVec2,
    /// Bins of the colour and of the ratio to the plate; `None` for unknown pixels, and outside of
    /// the searched rectangle.
    bins: Vec<Option<[u32; 2]>>,
    /// Number of bins of colours and of ratios.
    n_bins: [usize; 2],
    /// Histogram of the ratios.
    ratios: Vec<f64>,
    n: f64,
    /// Sizes of silhouettes, in pixels.
    areas_px: Vec<f64>,
    /// Corner of the searched rectangle.
    from_px: IVec2,
    to_px: IVec2,
    /// The pixel that all places are at, if there is one.
    tapped_px: Option<DVec2>,
}

impl<'a> Regions<'a> {
    fn new(level: &'a Level) -> Self {
        Self::within(level, extent(level))
    }

    /// Places at a pixel of the whole picture, wherever it differs from its plate.
    fn tapped(level: &'a Level, tapped_px: DVec2) -> Self {
        Self {
            tapped_px: Some(tapped_px),
            ..Self::within(level, (Vec::new(), IVec2::ZERO, level.frame.size_px))
        }
    }

    fn within(level: &'a Level, (areas_px, from_px, to_px): (Vec<f64>, IVec2, IVec2)) -> Self {
        let size_px = level.frame.size_px;
        let is_within = |at: IVec2| at.cmpge(from_px).all() && at.cmplt(to_px).all();
        let mut known: [BTreeMap<[i32; 3], u32>; 2] = [BTreeMap::new(), BTreeMap::new()];
        let mut bin_of = |which: usize, color: Color| {
            #[allow(clippy::cast_possible_truncation, reason = "logarithms of light")]
            let bin = color.map(|value| (value / BIN).round() as i32);
            let next = known[which].len();
            #[allow(clippy::cast_possible_truncation, reason = "no more than there are pixels")]
            *known[which].entry(bin).or_insert(next as u32)
        };
        let bins = places(size_px).map(|at| {
            let (color, ratio) = logarithms(level, at).filter(|_| is_within(at))?;
            Some([bin_of(0, color), bin_of(1, ratio)])
        });
        let bins: Vec<Option<[u32; 2]>> = bins.collect();
        let n_bins = [known[0].len(), known[1].len()];
        let mut ratios = vec![0.0; n_bins[1]];
        for [_, ratio] in bins.iter().flatten() {
            ratios[*ratio as usize] += 1.0;
        }
        Self {
            k: &level.intrinsics,
            size_px,
            n: ratios.iter().sum(),
            bins,
            n_bins,
            ratios,
            areas_px,
            from_px,
            to_px,
            tapped_px: None,
        }
    }

    /// The best place in a direction, in any size.
    fn best(&self, shape: &Shape, direction: ViewDirection) -> Option<Guess> {
        let rotation = DMat4::from_quat(direction.camera_from_upright());
        let upright = rotation * DMat4::from_translation(-shape.centre);
        let mut depth_m = 10.0 * shape.radius_m;
        let mut best: Option<Guess> = None;
        for area_px in &self.areas_px {
            let mut silhouette = self.silhouette(shape, &upright, depth_m);
            // Twice, since the view of a near toy differs from that of a far one.
            for _ in 0..2 {
                depth_m = (depth_m * (silhouette.len() as f64 / area_px).sqrt()).max(1.5 * shape.radius_m);
                silhouette = self.silhouette(shape, &upright, depth_m);
            }
            let found = self.best_place(&silhouette);
            let Some((at_px, cost)) = found.filter(|(_, cost)| best.is_none_or(|best| *cost < best.cost))
            else {
                continue;
            };
            best = Some(Guess {
                camera_from_upright: self.placed(at_px.as_dvec2(), depth_m) * upright,
                cost,
            });
        }
        best
    }

    /// The best place for a turn about a plane's normal.
    fn best_standing(&self, shape: &Shape, (standing, turn_rad): (Standing, f64)) -> Option<Guess> {
        let turn = DMat4::from_quat(DQuat::from_axis_angle(standing.normal, turn_rad));
        let turned = turn * DMat4::from_translation(-shape.centre);
        let middle_px = 0.5 * (self.from_px + self.to_px).as_dvec2();
        let mut at_px = self.tapped_px.unwrap_or(middle_px);
        let mut best: Option<Guess> = None;
        // Each move brings the silhouette nearer to the view of its place.
        for _ in 0..N_STANDING {
            let middle = self.seen_at(standing, at_px)?;
            let moved = DMat4::from_translation(middle) * turned;
            let silhouette = self.seen_silhouette(shape, &moved);
            let from = at_px.round().as_ivec2();
            let (to, cost) = self.best_place_from(&silhouette, from)?;
            if best.is_none_or(|best| cost < best.cost) {
                best = Some(Guess {
                    camera_from_upright: moved,
                    cost,
                });
            }
            if to == IVec2::ZERO {
                break;
            }
            at_px += to.as_dvec2();
        }
        best
    }

    /// The point of a plane at a pixel; `None` above its horizon.
    fn seen_at(&self, standing: Standing, at_px: DVec2) -> Option<DVec3> {
        let ray = self.k.ray(at_px);
        let toward = ray.dot(standing.normal);
        let depth = standing.point.dot(standing.normal) / toward;
        (toward.abs() > LEAST_SLOPE * ray.length() && depth > 0.0).then_some(depth * ray)
    }

    /// A toy in the centre of the picture, moved to another place with the same view.
    fn placed(&self, at_px: DVec2, depth_m: f64) -> DMat4 {
        let ray = DVec3::new(at_px.x / self.k.fx_px, -at_px.y / self.k.fy_px, -1.0);
        let turn = DQuat::from_rotation_arc(DVec3::NEG_Z, ray.normalize());
        DMat4::from_translation(depth_m * ray) * DMat4::from_quat(turn)
    }

    /// Pixels of the toy in the centre of the picture, relative to the principal point.
    fn silhouette(&self, shape: &Shape, camera_from_upright: &DMat4, depth_m: f64) -> Vec<IVec2> {
        let moved = DMat4::from_translation(DVec3::new(0.0, 0.0, -depth_m)) * *camera_from_upright;
        let points = shape.points.iter().map(|point| moved.transform_point3(*point));
        let k = Intrinsics {
            cx_px: self.size_px.x.into(),
            cy_px: self.size_px.y.into(),
            ..*self.k
        };
        let corners = project(points, &k);
        let coverage = Rasterizer::default().coverage(&corners, &shape.faces, 2 * self.size_px);
        let covered = coverage.pixels().filter(|at| coverage.at(*at) >= 0.5);
        covered.map(|at| at - self.size_px).collect()
    }

    /// Pixels of the toy in its place, relative to the principal point, also outside the picture.
    fn seen_silhouette(&self, shape: &Shape, camera_from_upright: &DMat4) -> Vec<IVec2> {
        let points = shape.points.iter();
        let points = points.map(|point| camera_from_upright.transform_point3(*point));
        let half_px = self.size_px / 2;
        let k = Intrinsics {
            cx_px: self.k.cx_px + f64::from(half_px.x),
            cy_px: self.k.cy_px + f64::from(half_px.y),
            ..*self.k
        };
        let corners = project(points, &k);
        let coverage = Rasterizer::default().coverage(&corners, &shape.faces, 2 * self.size_px);
        let covered = coverage.pixels().filter(|at| coverage.at(*at) >= 0.5);
        let middle = self.middle();
        covered.map(|at| at - half_px - middle).collect()
    }

    /// The shift with the lowest cost of a silhouette around a pixel.
    fn best_place_from(&self, silhouette: &[IVec2], from_px: IVec2) -> Option<(IVec2, f64)> {
        let span = (self.to_px - self.from_px) / STRIDE_PX;
        let is_tapped = self.is_tapped(silhouette);
        let coarse = places(span + 1).map(|at| self.from_px + STRIDE_PX * at - from_px);
        let (best, _) = self.best_of(silhouette, coarse.filter(|shift| is_tapped(*shift)))?;
        self.best_of(silhouette, beside(best).filter(|shift| is_tapped(*shift)))
    }

    /// Whether the tapped pixel is in a shifted silhouette's rectangle or little beside it; always
    /// if none was tapped.
    fn is_tapped(&self, silhouette: &[IVec2]) -> impl Fn(IVec2) -> bool + use<> {
        let tapped_px = self.tapped_px;
        let corners = silhouette.iter().copied();
        let from_px = corners.clone().reduce(IVec2::min).unwrap_or_default() + self.middle();
        let to_px = corners.reduce(IVec2::max).unwrap_or_default() + self.middle() + 1;
        let (from_px, to_px) = (from_px.as_dvec2(), to_px.as_dvec2());
        let reach_px = BESIDE * (to_px - from_px);
        move |shift| {
            tapped_px.is_none_or(|tapped_px| {
                let at_px = tapped_px - shift.as_dvec2();
                at_px.cmpge(from_px - reach_px).all() && at_px.cmple(to_px + reach_px).all()
            })
        }
    }

    fn middle(&self) -> IVec2 {
        DVec2::new(self.k.cx_px, self.k.cy_px).round().as_ivec2()
    }

    /// The shift from the principal point with the lowest cost.
    fn best_place(&self, silhouette: &[IVec2]) -> Option<(IVec2, f64)> {
        self.best_place_from(silhouette, self.middle())
    }

    fn best_of(&self, silhouette: &[IVec2], shifts: impl Iterator<Item = IVec2>) -> Option<(IVec2, f64)> {
        let costs = shifts.filter_map(|shift| Some((shift, self.cost(silhouette, shift)?)));
        costs.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// Mean entropy of a pixel; `None` if the silhouette leaves the searched rectangle.
    fn cost(&self, silhouette: &[IVec2], shift: IVec2) -> Option<f64> {
        let middle = self.middle();
        let mut colors = vec![0.0; self.n_bins[0]];
        let mut ratios = self.ratios.clone();
        let mut n_inside = 0.0;
        for at in silhouette {
            let bins = index_in(self.size_px, *at + shift + middle).and_then(|index| self.bins[index]);
            let Some([color, ratio]) = bins else { continue };
            colors[color as usize] += 1.0;
            ratios[ratio as usize] -= 1.0;
            n_inside += 1.0;
        }
        let is_inside = n_inside >= LEAST_INSIDE * silhouette.len() as f64 && n_inside > 0.0;
        is_inside.then(|| (entropy(&colors, n_inside) + entropy(&ratios, self.n - n_inside)) / self.n)
    }
}

/// The fine shifts around a coarse one.
fn beside(shift: IVec2) -> impl Iterator<Item = IVec2> {
    places(IVec2::splat(2 * STRIDE_PX - 1)).map(move |at| shift + at - (STRIDE_PX - 1))
}

/// Entropy of `n` values distributed over bins, in nats.
fn entropy(counts: &[f64], n: f64) -> f64 {
    let used = counts.iter().filter(|count| **count > 0.0);
    let terms = used.map(|count| {
        let density = (1.0 - ANY_COLOR) * count / n + ANY_COLOR / N_LIKELY_BINS;
        -count * density.ln()
    });
    terms.sum()
}

/// Possible sizes of the toy's silhouette, and the rectangle to search: around the changed area, if
/// there is a plate.
fn extent(level: &Level) -> (Vec<f64>, IVec2, IVec2) {
    let size_px = level.frame.size_px;
    let n_pixels = f64::from(size_px.x * size_px.y);
    let whole = (
        SHARES_OF_PICTURE.map(|share| share * n_pixels).to_vec(),
        IVec2::ZERO,
        size_px,
    );
    if level.plate.is_none() {
        return whole;
    }
    let changed = changed(level);
    if changed.is_empty() {
        return whole;
    }
    let n_changed = changed.len() as f64;
    // A distant speck is no part of it.
    let [x, y] = [0, 1].map(|axis| {
        let mut values: Vec<i32> = changed.iter().map(|at| at[axis]).collect();
        values.sort_unstable();
        let last = values.len() - 1;
        [values[last / 100], values[last - last / 100]]
    });
    #[allow(clippy::cast_possible_truncation, reason = "pixels")]
    let margin_px = (MARGIN * n_changed.sqrt()).ceil() as i32;
    let from_px = (IVec2::new(x[0], y[0]) - margin_px).max(IVec2::ZERO);
    let to_px = (IVec2::new(x[1], y[1]) + margin_px + 1).min(size_px);
    (SHARES.map(|share| share * n_changed).to_vec(), from_px, to_px)
}

/// Pixels that differ from the plate by more than light and noise; all without a plate.
pub(crate) fn changed(level: &Level) -> Vec<IVec2> {
    let size_px = level.frame.size_px;
    let ratios: Vec<(IVec2, Color)> = places(size_px)
        .filter_map(|at| Some((at, logarithms(level, at)?.1)))
        .collect();
    let median = [0, 1, 2].map(|channel| {
        let values = ratios.iter().map(|(_, ratio)| ratio[channel]);
        median(values, f32::total_cmp).unwrap_or(0.0)
    });
    let is_changed = |ratio: &Color| (0..3).any(|channel| (ratio[channel] - median[channel]).abs() > CHANGED);
    let changed = ratios
        .iter()
        .filter_map(|(at, ratio)| is_changed(ratio).then_some(*at));
    changed.collect()
}
