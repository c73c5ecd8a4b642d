//! Fits the toy's own texture, which an outline does not show.
//!
//! Points of the surface carry the logarithm of the shaded model, as soft as the picture, and the
//! gradient of its paint alone: shading does not move with the surface. Each step moves the points
//! until the logarithms of the picture under them are the model's, but for one gain in each cell
//! of the picture and in each channel: light that the model does not have changes slowly, a
//! texture does not. Source: Baker and Matthews 2004, section 3 (forward additive alignment), with
//! the template's own gradient.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, IVec2};

use super::paint::Shaded;
use super::placement::{Placement, Unknowns};
use crate::median::{DEVIATION_OF_MEDIAN, median};
use crate::picture::{Color, Level, Picture, UNKNOWN, places};
use crate::raster::{Coverage, project};
use crate::robust;
use app_scene::scene::Intrinsics;

/// Spreads of picture and model, in pixels, from the first round to the last: a wide one is met from some pixels away.
const SPREADS_PX: [f64; 3] = [3.0, 1.5, 0.7];
/// Rounds of each spread but the last.
const N_ROUNDS: usize = 2;
/// Round from which the spread is the last.
pub(super) const LAST_SPREAD: usize = N_ROUNDS * (SPREADS_PX.len() - 1);
/// The picture is known this far around the model, in pixels: steps are no longer.
const MARGIN_PX: i32 = 24;
/// Linear light below which logarithms are of noise.
const FLOOR: f32 = 0.01;
/// Linear light beyond which a channel is clipped.
const BRIGHTEST: f32 = 0.95;
/// Side of the cells that have one gain each, in pixels for each pixel of spread and at least; and the least number of points in one.
const CELL_PX: i32 = 12;
const LEAST_IN_CELL: usize = 6;
/// More points than that add nothing; fewer than the second number determine nothing.
const MOST_POINTS: usize = 3000;
const LEAST_POINTS: usize = 60;
/// Smallest change of the model's logarithm within the spread that counts as texture.
const LEAST_CHANGE: f64 = 0.03;
/// Scale of the robust weights, in deviations; and the least deviation of a logarithm: models are painted from other photographs.
const ROBUST: f64 = 3.0;
const LEAST_DEVIATION: f64 = 0.01;
/// Scale of the robust loss, as a logarithm.
const LOSS_SCALE: f64 = 0.1;
/// Area of points whose values err alike, in square pixels, which counts as one piece of evidence: points lie along the edges of the
/// texture, three pixels wide, and an outline counts once for 20 px.
const ALIKE_PX2: f64 = 60.0;
/// Correlation of model and picture within the cells, from which the model's paint is the toy's.
const LEAST_CORRELATION: f64 = 0.5;
/// Rounds of gains and weights.
const N_GAINS: usize = 3;

/// The model's paint over the picture, from the widest to the narrowest spread.
pub(super) struct Texture {
    layers: Vec<Layer>,
}

/// At one spread.
struct Layer {
    points: Vec<Point>,
    n_cells: usize,
    /// Area of the picture that each point stands for, in square pixels.
    area_px2: f64,
    /// Logarithms of the picture, from that corner on.
    picture: Picture,
    origin_px: IVec2,
}

/// A place on the toy.
struct Point {
    /// In camera space, as the toy was given.
    given: DVec3,
    cell: usize,
    /// Logarithms of the shaded model.
    shown: Color,
    /// Logarithms of its paint.
    paint: Color,
    /// Gradients of these over the picture, in 1/px.
    gradients: [DVec2; 3],
}

/// A number of the picture that should agree with the model's.
pub(super) struct Row {
    pub(super) at_px: DVec2,
    /// Derivative for each unknown.
    pub(super) row: Unknowns,
    /// Remaining difference.
    pub(super) residual: f64,
    pub(super) weight: f64,
}

/// Agreement of a model's paint with a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likeness {
    /// Mean robust loss of the logarithms.
    loss: f64,
    area_px2: f64,
    /// Correlation of model and picture within the cells.
    pub(super) correlation: f64,
}

impl Likeness {
    /// Log likelihood ratio of the picture for this placement against another one.
    pub(super) fn likelier_than(&self, other: &Self) -> f64 {
        let least = LEAST_DEVIATION * LEAST_DEVIATION;
        let n = self.area_px2.min(other.area_px2) / ALIKE_PX2;
        0.5 * n * (other.loss.max(least) / self.loss.max(least)).ln()
    }

    /// Whether the picture shows the model's paint.
    pub(super) fn is_of_model(&self) -> bool {
        self.correlation > LEAST_CORRELATION
    }
}

impl Texture {
    /// The texture of a toy near its estimated place; `None` if it has no texture there.
    pub(super) fn new(shaded: &Shaded<'_>, level: &Level, coverage: &Coverage) -> Option<Self> {
        let of_toy = |color: &dyn Fn(IVec2) -> Option<Color>| {
            let pixels = coverage.pixels().map(|at| color(at).unwrap_or(UNKNOWN));
            Picture::of(coverage.size_px, pixels.collect())
        };
        let model = Template {
            shown: of_toy(&|at| shaded.at(at)),
            paint: of_toy(&|at| shaded.color(at)),
        };
        let origin_px = coverage.origin_px - MARGIN_PX;
        let around = places(coverage.size_px + 2 * MARGIN_PX).map(|place| level.frame.get(origin_px + place));
        let unclipped = around.map(|color| {
            color
                .filter(|color| color.iter().all(|value| *value < BRIGHTEST))
                .unwrap_or(UNKNOWN)
        });
        let frame = Picture::of(coverage.size_px + 2 * MARGIN_PX, unclipped.collect());
        let layer = |spread_px: &f64| {
            Layer::new(
                *spread_px,
                (&model.logarithms(*spread_px), shaded),
                coverage.origin_px,
            )
            .map(|points| Layer {
                picture: logarithms(&frame, *spread_px),
                origin_px,
                ..points
            })
        };
        let layers: Vec<Layer> = SPREADS_PX.iter().filter_map(layer).collect();
        (!layers.is_empty()).then_some(Self { layers })
    }

    /// Differences between picture and model at a placement, with the sharpness of a round.
    pub(super) fn rows(&self, round: usize, placement: &Placement, k: &Intrinsics) -> Vec<Row> {
        let layer = &self.layers[(round / N_ROUNDS).min(self.layers.len() - 1)];
        Compared::new(layer, placement, k).rows(placement, k)
    }

    /// Agreement at the narrowest spread; `None` if too little of it is visible.
    pub(super) fn likeness(&self, placement: &Placement, k: &Intrinsics) -> Option<Likeness> {
        Compared::new(self.layers.last()?, placement, k).likeness()
    }
}

/// The model over the toy's pixels.
struct Template {
    shown: Picture,
    paint: Picture,
}

impl Template {
    fn logarithms(&self, spread_px: f64) -> Self {
        Self {
            shown: logarithms(&self.shown, spread_px),
            paint: logarithms(&self.paint, spread_px),
        }
    }
}

fn logarithms(picture: &Picture, spread_px: f64) -> Picture {
    let logarithm = |color: Color| color.map(|value| (value.max(0.0) + FLOOR).ln());
    picture.spread(spread_px).map(logarithm)
}

impl Layer {
    /// Points with texture, without a picture; `None` if there are too few.
    fn new(spread_px: f64, (model, shaded): (&Template, &Shaded<'_>), corner_px: IVec2) -> Option<Self> {
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let cell_px = (f64::from(CELL_PX) * spread_px.max(1.0)) as i32;
        let mut points: Vec<(IVec2, Point)> = places(model.shown.size_px)
            .filter_map(|place| Some((place, point(model, place, spread_px, shaded, corner_px)?)))
            .collect();
        let stride = points.len().div_ceil(MOST_POINTS).max(1);
        points = points.into_iter().step_by(stride).collect();
        let mut cells: BTreeMap<[i32; 2], Vec<usize>> = BTreeMap::new();
        for (index, (place, _)) in points.iter().enumerate() {
            let cell = place.div_euclid(IVec2::splat(cell_px)).to_array();
            cells.entry(cell).or_default().push(index);
        }
        cells.retain(|_, members| members.len() >= LEAST_IN_CELL);
        let mut of_points = vec![None; points.len()];
        for (cell, members) in cells.values().enumerate() {
            for member in members {
                of_points[*member] = Some(cell);
            }
        }
        let points = points.into_iter().zip(of_points);
        let points: Vec<Point> = points
            .filter_map(|((_, point), cell)| Some(Point { cell: cell?, ..point }))
            .collect();
        (points.len() >= LEAST_POINTS).then(|| Self {
            points,
            n_cells: cells.len(),
            area_px2: stride as f64,
            picture: Picture::of(IVec2::ZERO, Vec::new()),
            origin_px: IVec2::ZERO,
        })
    }
}

/// The point of the toy at a pixel of the model; `None` if it has no texture.
fn point(
    model: &Template,
    place: IVec2,
    spread_px: f64,
    shaded: &Shaded<'_>,
    corner_px: IVec2,
) -> Option<Point> {
    let (shown, paint) = (model.shown.get(place)?, model.paint.get(place)?);
    let [left, right, above, below] =
        [IVec2::NEG_X, IVec2::X, IVec2::NEG_Y, IVec2::Y].map(|step| model.paint.get(place + step));
    let (left, right, above, below) = (left?, right?, above?, below?);
    let gradients = [0, 1, 2].map(|channel| {
        let across = right[channel] - left[channel];
        let down = below[channel] - above[channel];
        0.5 * DVec2::new(f64::from(across), f64::from(down))
    });
    let steepest = gradients.iter().map(|gradient| gradient.length());
    let change = spread_px.max(1.0) * steepest.fold(0.0, f64::max);
    if change < LEAST_CHANGE {
        return None;
    }
    Some(Point {
        given: shaded.given(corner_px + place)?,
        cell: 0,
        shown,
        paint,
        gradients,
    })
}

/// Points compared with the picture at a placement.
struct Compared<'a> {
    layer: &'a Layer,
    /// Logarithm of picture over model, less the gain of the cell; `None` for unknown pixels of the
    /// picture.
    excess: Vec<Option<[f64; 3]>>,
    /// Positions of the points in the picture.
    at_px: Vec<DVec2>,
    weights: Vec<[f64; 3]>,
    variance: f64,
}

impl<'a> Compared<'a> {
    fn new(layer: &'a Layer, placement: &Placement, k: &Intrinsics) -> Self {
        let corner = layer.origin_px.as_dvec2();
        let now = layer.points.iter().map(|point| placement.apply(point.given));
        let at_px: Vec<DVec2> = project(now, k).into_iter().map(DVec3::truncate).collect();
        let differences = at_px.iter().zip(&layer.points).map(|(at_px, point)| {
            let seen = layer.picture.sample(*at_px - corner)?;
            Some([0, 1, 2].map(|channel| f64::from(seen[channel] - point.shown[channel])))
        });
        let mut compared = Self {
            layer,
            excess: differences.collect(),
            at_px,
            weights: vec![[1.0; 3]; layer.points.len()],
            variance: 1.0,
        };
        for _ in 0..N_GAINS {
            compared.take_gains();
            compared.weigh();
        }
        compared
    }

    /// Subtracts the mean of each cell from the excess.
    fn take_gains(&mut self) {
        let means = self.means(|index, channel| self.excess[index].map_or(0.0, |excess| excess[channel]));
        for (excess, point) in self.excess.iter_mut().zip(&self.layer.points) {
            if let Some(excess) = excess {
                for channel in 0..3 {
                    excess[channel] -= means[point.cell][channel];
                }
            }
        }
    }

    /// Weighted means over each cell and channel of values of the points.
    fn means<T>(&self, of: impl Fn(usize, usize) -> T) -> Vec<[T; 3]>
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T> + Default,
    {
        let mut sums = vec![[(T::default(), 0.0); 3]; self.layer.n_cells];
        for (index, point) in self.layer.points.iter().enumerate() {
            if self.excess[index].is_some() {
                let channels = sums[point.cell].iter_mut().zip(self.weights[index]);
                for (channel, ((sum, total), weight)) in channels.enumerate() {
                    *sum = *sum + of(index, channel) * weight;
                    *total += weight;
                }
            }
        }
        let mean = |(sum, total): (T, f64)| {
            if total > 0.0 {
                sum * (1.0 / total)
            } else {
                T::default()
            }
        };
        sums.into_iter().map(|cell| cell.map(mean)).collect()
    }

    /// Sets weights from each value's distance from the majority.
    fn weigh(&mut self) {
        let excess = self.excess.iter().flatten().flatten();
        let away = median(excess.map(|excess| excess.abs()), f64::total_cmp);
        let median = away.unwrap_or(LEAST_DEVIATION);
        let deviation = (DEVIATION_OF_MEDIAN * median).max(LEAST_DEVIATION);
        self.variance = deviation * deviation;
        let scale = (ROBUST * deviation).powi(2);
        for (weights, excess) in self.weights.iter_mut().zip(&self.excess) {
            if let Some(excess) = excess {
                *weights = excess.map(|excess| robust::weight(excess * excess / scale));
            }
        }
    }

    fn rows(&self, placement: &Placement, k: &Intrinsics) -> Vec<Row> {
        let points = &self.layer.points;
        let changes: Vec<[Unknowns; 3]> = points
            .iter()
            .map(|point| {
                point
                    .gradients
                    .map(|gradient| change(placement, point.given, gradient, k))
            })
            .collect();
        let means = self.means(|index, channel| changes[index][channel]);
        let weight = self.layer.area_px2 / (ALIKE_PX2 * self.variance);
        let mut rows = Vec::new();
        for (index, point) in points.iter().enumerate() {
            let Some(excess) = self.excess[index] else {
                continue;
            };
            for channel in 0..3 {
                rows.push(Row {
                    at_px: self.at_px[index],
                    row: changes[index][channel] - means[point.cell][channel],
                    residual: -excess[channel],
                    weight: weight * self.weights[index][channel],
                });
            }
        }
        rows
    }

    fn likeness(&self) -> Option<Likeness> {
        let means = self.means(|index, channel| f64::from(self.layer.points[index].paint[channel]));
        let (mut loss, mut n) = (0.0, 0.0);
        let (mut of_both, mut of_model, mut of_picture) = (0.0, 0.0, 0.0);
        for (index, point) in self.layer.points.iter().enumerate() {
            let Some(excess) = self.excess[index] else {
                continue;
            };
            for channel in 0..3 {
                let weight = self.weights[index][channel];
                let model = f64::from(point.paint[channel]) - means[point.cell][channel];
                let picture = model + excess[channel];
                loss += robust::loss(excess[channel].powi(2), LOSS_SCALE * LOSS_SCALE);
                n += 1.0;
                of_both += weight * model * picture;
                of_model += weight * model * model;
                of_picture += weight * picture * picture;
            }
        }
        let spread = (of_model * of_picture).sqrt();
        (n >= 3.0 * LEAST_POINTS as f64 && spread > 0.0).then(|| Likeness {
            loss: loss / n,
            area_px2: n / 3.0 * self.layer.area_px2,
            correlation: of_both / spread,
        })
    }
}

/// Change of the paint's logarithm at a fixed place of the picture for each unknown, if the toy's
/// point moves over a gradient.
fn change(placement: &Placement, given: DVec3, gradient: DVec2, k: &Intrinsics) -> Unknowns {
    let now = placement.apply(given);
    let depth_m = -now.z;
    let (across, down) = (gradient.x * k.fx_px, -gradient.y * k.fy_px);
    let along = (across * now.x + down * now.y) / depth_m;
    placement.row(now, DVec3::new(across, down, along) / depth_m)
}
