//! Estimates the plane of a thing, such as the top of a book or a ramp, from the toy's shadow on it.
//!
//! The shadow on a plane is the toy projected onto it. The search varies a plane's height and tilt
//! until the predicted shadow matches the photograph. The remaining loss decides whether the thing
//! has a plane at all: a cup, a cloth or a hand has none. If a depth sensor measured the thing, the
//! search begins with the plane of its points and stays close to it, and the loss only has to agree.

use glam::{DMat4, DQuat, DVec2, DVec3, IVec2, Vec3Swizzles};

use super::extent::Extent;
use super::measured::Measured;
use super::seeds::Colored;
use super::shadow_loss::{self, MOST_LOSS, square};
use super::simplex::descend;
use crate::lights::{Compared, Comparison, OnPlane};
use crate::measured_points::MeasuredPoints;
use crate::picture::{Color, Level, brightness};
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::report::PlaneAlignment;
use crate::shape::Shape;
use app_scene::scene::Intrinsics;

/// Most pixels of the level that a search samples.
const MOST_PIXELS: usize = 2500;
/// Least shadowed pixels that a level and a tilted plane need; the same for one that is beyond doubt,
/// and its largest loss over the smaller one of the known receivers and of no shadow at all.
/// Where a husky's tail crosses two books, 66 and 78 pixels have 2e-4 and .01 of it; 160 on a llama's ramp
/// have .01 and .03, and .08 in a light that is a degree off. Mugs have .43 and more, or no
/// such pixel.
const LEAST_SHADOWED: [usize; 2] = [90, 250];
const LEAST_BEYOND_DOUBT: [usize; 2] = [45, 90];
const BEYOND_DOUBT: [f64; 2] = [0.03, 0.1];
/// Least part of the light that a shadowed pixel loses.
pub(super) const SHADOWED: f32 = 0.25;
/// Largest loss of an accepted plane: absolute, and over the smaller loss of the known receivers and
/// of no shadow at all.
const OF_PLANE: f64 = 0.0012;
const OF_OTHERS: f64 = 0.35;
/// The same for a side that has to be proved: its place is known, so that nothing is searched.
const OF_OTHERS_SIDE: f64 = 0.6;
/// Largest loss of a plane that a depth sensor measured, and the addition to the losses of the
/// others for noise.
const OF_MEASURED: f64 = 0.003;
const NOISE: f64 = 1e-4;
/// Loss of a squared deviation from the plane of a depth sensor.
const OFF_MEASURED: f64 = 1e-4;
/// If known receivers, or no shadow at all, leave a smaller loss, there is nothing to explain.
const LEAST_LEFT: f64 = 3e-4;
/// The same for a listed plane. One that is 2 mm off leaves 4e-4, an exact one 1e-5.
const LEAST_LISTED: f64 = 1e-4;
/// How much smaller the loss must be if the thing may have the place's colours: a ramp of the
/// table's own wood has 3e-6 in place of 5e-3.
const ALIKE_TIMES: f64 = 2.0;
/// Largest distance in metres between a found plane and the receiver that it replaces.
const SAME_M: f64 = 0.012;
/// The receiver nearest to the toy, which stands on it.
pub(super) const GROUND: usize = 0;
/// A level plane wins if its loss is at most this factor times a tilted plane's, plus a constant. The
/// first factor is for a tilted plane that is flatter than `FLAT`, the second one for a steeper one.
/// Shadows on 14 books have slopes of up to .04, with losses of level planes up to 2.4 times as large; eight ramps
/// have .17 and more, with losses 2.9 to 1400 times as large.
const LEVEL_TIMES: [f64; 2] = [3.0, 1.3];
const LEVEL_MORE: f64 = 1e-4;
const FLAT: f64 = 0.05;
/// Heights of the first search, over the toy's radius: the first, the step, and their number.
const HEIGHTS: (f64, f64, usize) = (-0.03, 0.03, 24);
/// Slopes of the first search, and the directions of each.
const SLOPES: [f64; 2] = [0.1, 0.22];
const N_SIDES: usize = 8;
/// Steepest slope, the part of it from which on a search has ended there, and largest depth of a plane below
/// the receiver, in metres.
const STEEPEST: f64 = 0.6;
const AT_STEEPEST: f64 = 0.9;
const BELOW_M: f64 = 0.004;
/// Distance from the thing's middle up to which it may reach, over the size of its certain pixels.
const REACH: f64 = 3.0;
/// Starts of the descents, their first steps over the toy's radius, and the tries of each.
const N_STARTS: usize = 2;
const FIRST_STEP: f64 = 0.05;
const N_TRIES: usize = 60;
/// Least pixels that contradict a plane.
const LEAST_CONTRADICTING: usize = 60;
/// Side of the cells that merge the toy's vertices, in pixels of the level.
pub(super) const CELL_PX: f64 = 0.7;

/// A plane with its extent and its evidence.
pub(crate) struct FoundPlane {
    pub(crate) plane: SeenReceiver,
    /// Index of the receiver that it replaces: one above the toy's ground that is listed slightly
    /// off.
    pub(crate) instead_of: Option<usize>,
    pub(crate) report: PlaneAlignment,
    /// Contrast of its sides in the plate, in logarithms of light; 0 for a listed or an upright one.
    pub(super) contrast: f64,
}

/// Whether found planes end at clearer edges than others, or there are no others.
pub(super) fn is_clearer(planes: &[FoundPlane], others: &[FoundPlane]) -> bool {
    let contrast = |planes: &[FoundPlane]| planes.iter().map(|found| found.contrast).fold(0.0, f64::max);
    contrast(planes) > contrast(others) || (others.is_empty() && !planes.is_empty())
}

impl FoundPlane {
    /// Whether its centre is close to a receiver.
    pub(super) fn is_near(&self, receiver: &SeenReceiver) -> bool {
        let middle = self.plane.plane_from_camera.inverse().w_axis.truncate();
        receiver.plane_from_camera.transform_point3(middle).y.abs() < SAME_M
    }
}

/// The toy with its vertices merged, the known receivers and measured points, in camera space.
pub(super) struct Place<'a> {
    pub(super) shape: &'a Shape,
    pub(super) receivers: &'a [SeenReceiver],
    pub(super) points: &'a [MeasuredPoints],
    /// Whether the things are those of exact points, which then bound their planes.
    pub(super) are_things_of_points: bool,
}

/// A plane near a listed one.
pub(super) struct Nearer {
    /// Rigid; without bounds.
    pub(super) plane_from_camera: DMat4,
    /// Losses of the known receivers and of the plane.
    pub(super) losses: [f64; 2],
}

/// A candidate for a thing's plane.
pub(super) struct Candidate {
    pub(super) heights: Heights,
    pub(super) loss: f64,
    pub(super) is_level: bool,
}

/// Parameters of a plane, in metres: its height above the receiver at the thing's centre, and its
/// rise over the thing's size along either axis.
pub(super) type Heights = [f64; 3];

/// A search for one thing's plane.
#[derive(Clone)]
pub(super) struct Search<'a> {
    pub(super) comparison: &'a Comparison,
    pub(super) on_plane: OnPlane<'a>,
    pub(super) table: &'a SeenReceiver,
    pub(super) intrinsics: Intrinsics,
    /// Sampling stride of the pixels.
    apart: usize,
    pixels: Vec<IVec2>,
    seen: Vec<(Color, f32)>,
    /// Prediction of the known receivers.
    expected: Vec<Option<Color>>,
    /// Centre and size on the receiver of the thing, or of the shadow on it, in metres.
    pub(super) middle: DVec2,
    pub(super) size_m: f64,
    /// Distance from the centre up to which the thing may reach, in metres.
    pub(super) reach_m: f64,
    radius_m: f64,
    /// The plane that a depth sensor measured.
    pub(super) measured: Option<Measured>,
    /// Whether each pixel shows the plane or the known receivers, whichever explains it better.
    pub(super) is_mixed: bool,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        (shape, receivers): (&'a Shape, &'a [SeenReceiver]),
        level: &Level,
        comparison: &'a Comparison,
        pixels: &[&Compared],
    ) -> Option<Self> {
        let table = receivers.get(GROUND)?;
        let (middle, size_m) = place_on(table, &level.intrinsics, pixels)?;
        let search = Self {
            comparison,
            on_plane: OnPlane::new(comparison, (shape, receivers), GROUND, level),
            table,
            intrinsics: level.intrinsics,
            apart: 1,
            pixels: Vec::new(),
            seen: Vec::new(),
            expected: Vec::new(),
            middle,
            size_m,
            reach_m: REACH * size_m,
            radius_m: shape.radius_m,
            measured: None,
            is_mixed: false,
        };
        Some(search.of_pixels(pixels))
    }

    /// The same search, about the place of some pixels; `None` if they have none.
    pub(super) fn about(&self, pixels: &[&Compared]) -> Option<Self> {
        let (middle, size_m) = place_on(self.table, &self.intrinsics, pixels)?;
        Some(Self {
            middle,
            size_m,
            ..self.clone()
        })
    }

    /// The same search, with other pixels.
    pub(super) fn of_pixels(self, pixels: &[&Compared]) -> Self {
        let apart = pixels.len().div_ceil(MOST_PIXELS).max(1);
        let looked_at = || pixels.iter().step_by(apart);
        Self {
            apart,
            pixels: looked_at().map(|pixel| pixel.at).collect(),
            seen: looked_at().map(|pixel| (pixel.ratio, pixel.noise())).collect(),
            expected: looked_at().map(|pixel| Some(pixel.model)).collect(),
            ..self
        }
    }

    /// The plane near a listed one that explains the shadow far better; `None` if there is none.
    pub(super) fn nearer(&self, raster: &mut Rasterizer, listed: &SeenReceiver) -> Option<Nearer> {
        let (of_listed, of_others) = self.known_losses();
        if of_others <= LEAST_LISTED {
            return None;
        }
        let table_from_plane = self.table.own_from_plane(&listed.plane_from_camera);
        let (normal, origin) = (
            table_from_plane.y_axis.truncate(),
            table_from_plane.w_axis.truncate(),
        );
        let slope = -normal.xz() / normal.y;
        let height_m = origin.y + slope.dot(self.middle - origin.xz());
        let starts = [
            [height_m, 0.0, 0.0],
            [height_m, slope.x * self.size_m, slope.y * self.size_m],
        ];
        let [level, tilted] = starts;
        let nearer = self.refined(raster, &[level], &[tilted])?;
        let is_better = nearer.loss < OF_OTHERS * of_others;
        (is_better && self.is_shown(raster, &nearer, LEAST_SHADOWED)).then(|| Nearer {
            losses: [of_listed, nearer.loss],
            plane_from_camera: self.plane(&nearer.heights).plane_from_camera,
        })
    }

    /// A found plane with its bounds and losses.
    pub(super) fn reported(
        &self,
        extent: &Extent,
        (endless, candidate): (&DMat4, &Candidate),
        level: &Level,
        losses: [f64; 2],
    ) -> FoundPlane {
        FoundPlane {
            plane: extent.plane(endless),
            instead_of: None,
            contrast: extent.contrast(level, endless, self.table),
            report: PlaneAlignment {
                height_m: extent.height_m(endless, self.table),
                tilt_rad: self.slope(&candidate.heights).atan(),
                half_extent_m: extent.half_m.to_array(),
                losses,
            },
        }
    }

    /// The plane with the smallest residual.
    pub(super) fn best_plane(&self, raster: &mut Rasterizer) -> Option<Candidate> {
        let (first, step, n) = HEIGHTS;
        let level = (0..n).map(|i| [(first + step * i as f64) * self.radius_m, 0.0, 0.0]);
        let measured = self
            .measured
            .as_ref()
            .map(|measured| measured.heights(self.size_m));
        let level = level.chain(measured.map(|heights| [heights[0], 0.0, 0.0]));
        let level = self.best(raster, level, N_STARTS + 1);
        let slopes = level.iter().flat_map(|[height_m, ..]| {
            SLOPES.into_iter().flat_map(move |slope| {
                (0..N_SIDES).map(move |side| {
                    let to = DVec2::from_angle(std::f64::consts::TAU * side as f64 / N_SIDES as f64);
                    [*height_m, slope * to.x * self.size_m, slope * to.y * self.size_m]
                })
            })
        });
        let all = level.iter().copied().chain(slopes);
        let all: Vec<Heights> = all.chain(measured).collect();
        let tilted = self.best(raster, all.into_iter(), N_STARTS);
        self.refined(raster, &level, &tilted)
    }

    /// The best plane after descents from some level and some tilted ones.
    pub(super) fn refined(
        &self,
        raster: &mut Rasterizer,
        level: &[Heights],
        tilted: &[Heights],
    ) -> Option<Candidate> {
        let step_m = FIRST_STEP * self.radius_m;
        let mut descended = |starts: &[Heights], n_free: usize| {
            let ends = starts.iter().map(|start| {
                descend((*start, step_m), n_free, N_TRIES, |heights| {
                    self.loss(raster, heights)
                })
            });
            ends.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let (level, tilted) = (descended(level, 1)?, descended(tilted, 3)?);
        let times = LEVEL_TIMES[usize::from(self.slope(&tilted.1) > FLAT)];
        let is_level = level.0 <= times * tilted.0 + LEVEL_MORE;
        let (loss, heights) = if is_level { level } else { tilted };
        Some(Candidate {
            heights,
            loss,
            is_level,
        })
    }

    /// The same search, restricted to the pixels of a rectangle.
    pub(super) fn within(mut self, plane: &SeenReceiver) -> Self {
        let k = self.intrinsics;
        let is_within: Vec<bool> = self
            .pixels
            .iter()
            .map(|at| plane.point_at(&k, *at).is_some())
            .collect();
        keep(&mut self.pixels, &is_within);
        keep(&mut self.seen, &is_within);
        keep(&mut self.expected, &is_within);
        self
    }

    /// Whether the picture shows that its pixels are not on a plane.
    pub(super) fn is_contradicted(&self, raster: &mut Rasterizer, heights: &Heights) -> bool {
        let loss = self.loss_of(&self.ratios(raster, &self.plane(heights)));
        self.apart * self.pixels.len() >= LEAST_CONTRADICTING && loss > OF_PLANE
    }

    /// Losses of the known receivers and of the plane; `None` if the plane is no clear improvement, or as steep
    /// as the search permits: an upright board in two lights came out so.
    pub(super) fn significant_losses(
        &self,
        raster: &mut Rasterizer,
        candidate: &Candidate,
        colored: Colored,
    ) -> Option<[f64; 2]> {
        let (of_receiver, of_others) = self.known_losses();
        let loss = candidate.loss;
        if self.measured.is_some() {
            let is_agreed = loss < OF_MEASURED.min(of_others + NOISE);
            return is_agreed.then_some([of_receiver, loss]);
        }
        let times = match colored {
            Colored::Otherwise => 1.0,
            Colored::Alike => ALIKE_TIMES,
        };
        let is_significant = of_others > LEAST_LEFT && times * loss < OF_PLANE.min(OF_OTHERS * of_others);
        let is_beyond_doubt = loss < BEYOND_DOUBT[usize::from(!candidate.is_level)] * of_others;
        let least = if is_beyond_doubt {
            LEAST_BEYOND_DOUBT
        } else {
            LEAST_SHADOWED
        };
        let is_steepest = self.slope(&candidate.heights) > AT_STEEPEST * STEEPEST;
        let is_found = is_significant && !is_steepest && self.is_shown(raster, candidate, least);
        is_found.then_some([of_receiver, loss])
    }

    /// Losses of the known receivers and of an upright side; `None` if those, or no shadow at all,
    /// explain the pixels better, or not far worse although the side has to be proved.
    pub(super) fn agreed_losses(
        &self,
        raster: &mut Rasterizer,
        plane: &SeenReceiver,
        is_to_prove: bool,
    ) -> Option<[f64; 2]> {
        let loss = self.loss_of(&self.ratios(raster, plane));
        let (of_receiver, of_others) = self.known_losses();
        let is_agreed = if is_to_prove {
            of_others > LEAST_LEFT && loss < OF_OTHERS_SIDE * of_others
        } else {
            loss < of_others + NOISE
        };
        is_agreed.then_some([of_receiver, loss])
    }

    /// Loss of the known receivers, and the smaller one of theirs and of no shadow at all.
    fn known_losses(&self) -> (f64, f64) {
        let of_receiver = self.loss_of(&self.expected);
        let of_light = self.loss_of(&vec![Some([1.0; 3]); self.seen.len()]);
        (of_receiver, of_receiver.min(of_light))
    }

    /// The best of some tries, from the best one.
    fn best(&self, raster: &mut Rasterizer, tries: impl Iterator<Item = Heights>, n: usize) -> Vec<Heights> {
        let mut tried: Vec<(f64, Heights)> = tries
            .map(|heights| (self.loss(raster, &heights), heights))
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.into_iter().take(n).map(|(_, heights)| heights).collect()
    }

    /// Rise of a plane over a metre.
    fn slope(&self, [_, along_x, along_z]: &Heights) -> f64 {
        along_x.hypot(*along_z) / self.size_m
    }

    pub(super) fn plane(&self, [height_m, along_x, along_z]: &Heights) -> SeenReceiver {
        let slope = DVec2::new(*along_x, *along_z) / self.size_m;
        let normal = DVec3::new(-slope.x, 1.0, -slope.y).normalize();
        let turn = DQuat::from_rotation_arc(DVec3::Y, normal);
        let origin = DVec3::new(self.middle.x, *height_m, self.middle.y);
        let plane_from_table = DMat4::from_rotation_translation(turn, origin).inverse();
        SeenReceiver::of_size(plane_from_table * self.table.plane_from_camera, DVec2::INFINITY)
    }

    /// Mean squared difference between photograph and prediction of a plane, in plates.
    fn loss(&self, raster: &mut Rasterizer, heights: &Heights) -> f64 {
        let steepest_m = STEEPEST * self.size_m;
        let rise_m = heights[1].hypot(heights[2]);
        if rise_m > steepest_m || heights[0] - rise_m < -BELOW_M - 0.5 * rise_m {
            return f64::INFINITY;
        }
        let expected = self.ratios(raster, &self.plane(heights));
        let measured = self.measured.as_ref();
        let off = measured.map_or(0.0, |measured| measured.square(heights, self.size_m));
        self.loss_of(&expected) + OFF_MEASURED * off
    }

    /// The same for a prediction of each pixel, if there is one.
    fn loss_of(&self, expected: &[Option<Color>]) -> f64 {
        let depth = self.depth(expected);
        let pixels = expected.iter().zip(&self.expected).zip(&self.seen);
        let losses = pixels.map(|((expected, known), seen)| {
            let square = |expected: &Option<Color>, depth| {
                expected.map_or(MOST_LOSS, |expected| square(seen, expected, depth))
            };
            let of_known = if self.is_mixed {
                square(known, 1.0)
            } else {
                MOST_LOSS
            };
            square(expected, depth).min(of_known)
        });
        losses.sum::<f64>() / self.seen.len().max(1) as f64
    }

    /// Depth of the shadow over a prediction of each pixel.
    pub(super) fn depth(&self, expected: &[Option<Color>]) -> f64 {
        shadow_loss::depth(&self.seen, expected)
    }

    /// Whether enough of the shadow falls on a plane: the least for a level and for a tilted one.
    fn is_shown(&self, raster: &mut Rasterizer, candidate: &Candidate, least: [usize; 2]) -> bool {
        let expected = self.ratios(raster, &self.plane(&candidate.heights));
        let shadowed = expected
            .iter()
            .flatten()
            .filter(|color| brightness(color) < 1.0 - SHADOWED);
        self.apart * shadowed.count() >= least[usize::from(!candidate.is_level)]
    }

    /// Prediction of a plane for each pixel that shows it.
    pub(super) fn ratios(&self, raster: &mut Rasterizer, plane: &SeenReceiver) -> Vec<Option<Color>> {
        self.on_plane.ratios(raster, plane, &self.pixels)
    }
}

/// Centre of pixels on a receiver and their mean distance from it, as a root mean square, in metres; `None` if
/// they show less than two places.
fn place_on(receiver: &SeenReceiver, intrinsics: &Intrinsics, pixels: &[&Compared]) -> Option<(DVec2, f64)> {
    let points = pixels
        .iter()
        .filter_map(|pixel| receiver.point_at(intrinsics, pixel.at));
    let places: Vec<DVec2> = points
        .map(|point| receiver.plane_from_camera.transform_point3(point).xz())
        .collect();
    let n = places.len().max(1) as f64;
    let middle = places.iter().sum::<DVec2>() / n;
    let square = places.iter().map(|at| at.distance_squared(middle)).sum::<f64>() / n;
    (square > 0.0).then(|| (middle, square.sqrt()))
}

/// Keeps the marked values.
fn keep<T>(values: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    values.retain(|_| marks.next().is_some_and(|is_kept| *is_kept));
}
