//! A smooth field of displacements of a toy's surface, by those of its outline: a Gaussian process.
//!
//! Nearby points on the same side of the toy have similar displacements, mostly along the normals.
//! Amplitude and length scale maximise the likelihood of the picture, at some tenths of a
//! millimetre and some millimetres on a toy of 10 cm. The pose is fixed. The remaining distance of
//! the outline is a displacement of the surface, and fades out away from the outline.
//!
//! Source: Rasmussen and Williams 2006, sections 2.2 and 5.4; iteratively reweighted as by Geman
//! and McClure 1987.

use std::collections::BTreeMap;

use glam::DVec3;
use nalgebra::{DMatrix, DVector};

use super::contour_segments::ContourSegment;
use super::settle::{ALIKE, OFFSET_PX};
use crate::median::median;
use crate::robust;
use crate::shape::Shape;

/// Standard deviations of the displacements to try, over the toy's radius: for a toy of 10 cm from
/// .1 to 1.2 mm.
const DEVIATIONS: [f64; 4] = [0.002, 0.004, 0.008, 0.016];
/// Length scales to try, over the toy's radius: from 3 to 7 mm.
const LENGTHS: [f64; 3] = [0.045, 0.065, 0.095];
/// Smallest length scale that an outline constrains, in pixels.
const LEAST_LENGTH_PX: f64 = 4.0;
/// Distance over the length scale beyond which points are uncorrelated.
const APART: f64 = 4.0;
/// Fraction of a displacement's variance that is not along the normal: feet, ears and tails bend.
const ANY_WAY: f64 = 0.2;
/// Correlation length of a camera's displacements of outlines, in pixels.
const ALIKE_PX: f64 = 10.0;
/// Displacements beyond this many medians mostly belong to something else, for example a shadow
/// beside the toy.
const FAR: f64 = 3.0;
/// Lower bound of that median, in pixels: the median of a matching outline.
const LEAST_MEDIAN_PX: f64 = 0.1;
/// Scale of the residuals' weights over their median, and its bounds in pixels.
const ROBUST: f64 = 3.0;
const LEAST_ROBUST_PX: f64 = 0.15;
const MOST_ROBUST_PX: f64 = 0.6;
/// The smallest weight of an outlier.
const LEAST_WEIGHT: f64 = 1e-4;
/// Rounds of reweighting, and the number of them in which lengths and deviations are estimated.
const N_ROUNDS: usize = 4;
const N_LOOKED_FOR: usize = 2;

/// The displaced surface, in camera space.
#[derive(Clone, Copy)]
pub(super) struct Skin<'a> {
    pub(super) shape: &'a Shape,
    /// Unit normal of each point of the shape; zero if it has no outside.
    pub(super) normals: &'a [DVec3],
}

/// A camera's error of an outline, and the size of its pixels.
#[derive(Clone, Copy)]
pub(super) struct Camera {
    /// Standard deviation of its displacements of a correct model's outline, along some pixels.
    pub(super) alike_px: f64,
    /// Side of a pixel at the toy's distance.
    pub(super) pixel_m: f64,
    /// Side of the squares of a segment.
    pub(super) cell_px: f64,
}

/// A field, by its displacement of each point of the surface in camera space.
pub(super) struct Field {
    pub(super) displacements_m: Vec<DVec3>,
    /// Logarithm of how much likelier the outline is with a field than without, whatever field that is: its freedoms are counted.
    pub(super) evidence: f64,
}

/// Amplitude and length scale of the displacements.
#[derive(Clone, Copy)]
struct Prior {
    deviation_m: f64,
    /// Among those that are tried.
    length: usize,
}

impl Field {
    /// The field of largest likelihood; `None` if nothing of the outline is visible.
    pub(super) fn found(skin: Skin<'_>, segments: &[ContourSegment], camera: Camera) -> Option<Self> {
        if segments.is_empty() {
            return None;
        }
        let process = Process::new(skin, segments, camera);
        let far_px = FAR * median_size(process.offsets.iter()).max(LEAST_MEDIAN_PX);
        let near: Vec<f64> = weights(&process.offsets, far_px);
        let mut robust = near.clone();
        let mut prior = None;
        for round in 0..N_ROUNDS {
            let (best, pulls) = process.likeliest(&robust, prior.filter(|_| round >= N_LOOKED_FOR))?;
            prior = Some(best);
            let left = &process.offsets - process.covariance(best) * &pulls;
            let scale_px = (ROBUST * median_size(left.iter())).clamp(LEAST_ROBUST_PX, MOST_ROBUST_PX);
            let fitting = weights(&left, scale_px).into_iter().zip(&near);
            robust = fitting
                .map(|(weight, near)| weight.max(LEAST_WEIGHT) * near)
                .collect();
        }
        let (prior, pulls) = process.likeliest(&robust, prior)?;
        Some(Self {
            displacements_m: process.displacements(&pulls, prior),
            evidence: process.evidence(&robust, prior)?,
        })
    }
}

/// The outline, and the covariance of its pieces.
struct Process<'a> {
    skin: Skin<'a>,
    segments: &'a [ContourSegment],
    offsets: DVector<f64>,
    /// Covariance of the camera's displacements, in square pixels.
    common: DMatrix<f64>,
    cell_px: f64,
    lengths_m: [f64; LENGTHS.len()],
    /// For each length scale, covariance of the offsets by a field with a standard deviation of one
    /// metre.
    unit: [DMatrix<f64>; LENGTHS.len()],
}

impl<'a> Process<'a> {
    fn new(skin: Skin<'a>, segments: &'a [ContourSegment], camera: Camera) -> Self {
        let lengths_m =
            LENGTHS.map(|length| (length * skin.shape.radius_m).max(LEAST_LENGTH_PX * camera.pixel_m));
        Self {
            offsets: DVector::from_iterator(segments.len(), segments.iter().map(|one| one.offset_px)),
            common: common(segments, camera.alike_px),
            unit: lengths_m.map(|length_m| unit(skin, segments, length_m)),
            cell_px: camera.cell_px,
            lengths_m,
            skin,
            segments,
        }
    }

    fn covariance(&self, prior: Prior) -> DMatrix<f64> {
        &self.unit[prior.length] * prior.deviation_m.powi(2)
    }

    /// Covariance of the noise, if neighbouring pieces are correlated over `alike` segments.
    fn noise(&self, robust: &[f64], alike: f64) -> DMatrix<f64> {
        let mut noise = self.common.clone();
        for (index, (one, weight)) in self.segments.iter().zip(robust).enumerate() {
            noise[(index, index)] += alike * one.variance_px2 / weight;
        }
        noise
    }

    /// The most likely prior, or the given one, and the weight of each offset in the field with it.
    fn likeliest(&self, robust: &[f64], given: Option<Prior>) -> Option<(Prior, DVector<f64>)> {
        let noise = self.noise(robust, 1.0);
        let priors: Vec<Prior> = match given {
            Some(prior) => vec![prior],
            None => priors(self.skin.shape.radius_m).collect(),
        };
        let tried = priors.into_iter().filter_map(|prior| {
            let (likelihood, pulls) = explained(&noise + self.covariance(prior), &self.offsets)?;
            Some((likelihood, prior, pulls))
        });
        let (_, prior, pulls) = tried.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((prior, pulls))
    }

    /// Logarithm of the likelihood ratio of the offsets with and without a field; neighbouring
    /// pieces count once.
    fn evidence(&self, robust: &[f64], prior: Prior) -> Option<f64> {
        let noise = self.noise(robust, (ALIKE / self.cell_px).max(1.0));
        let (with, _) = explained(&noise + self.covariance(prior), &self.offsets)?;
        let (without, _) = explained(noise, &self.offsets)?;
        Some(with - without)
    }

    /// The mean of the field at each point.
    fn displacements(&self, pulls: &DVector<f64>, prior: Prior) -> Vec<DVec3> {
        let mut pulled: BTreeMap<usize, DVec3> = BTreeMap::new();
        for (segment, pull) in self.segments.iter().zip(pulls.iter()) {
            for (point, px_per_m) in &segment.row {
                *pulled.entry(*point).or_default() += *pull * *px_per_m;
            }
        }
        let (skin, length_m) = (self.skin, self.lengths_m[prior.length]);
        let variance = prior.deviation_m.powi(2);
        let at = |point: usize| {
            let pulled = pulled.iter();
            let sum: DVec3 = pulled
                .map(|(other, pull)| skin.carried(point, *other, *pull, length_m))
                .sum();
            variance * sum
        };
        (0..skin.shape.points.len()).map(at).collect()
    }
}

fn priors(radius_m: f64) -> impl Iterator<Item = Prior> {
    let of_length = move |length| {
        DEVIATIONS.into_iter().map(move |deviation| Prior {
            deviation_m: deviation * radius_m,
            length,
        })
    };
    (0..LENGTHS.len()).flat_map(of_length)
}

impl Skin<'_> {
    /// The displacement of a point by a pull at another one, if displacements have a standard
    /// deviation of one metre.
    fn carried(&self, point: usize, other: usize, pull: DVec3, length_m: f64) -> DVec3 {
        let points = &self.shape.points;
        let square = (points[point] - points[other]).length_squared() / (length_m * length_m);
        if square > APART * APART {
            return DVec3::ZERO;
        }
        let (here, there) = (self.normals[point], self.normals[other]);
        let same_side = 0.5 + 0.5 * here.dot(there);
        let along = here * there.dot(pull) * (same_side * same_side);
        (-0.5 * square).exp() * (ANY_WAY * pull + (1.0 - ANY_WAY) * along)
    }
}

/// Logarithm of the likelihood of offsets with a covariance, up to a constant, and the inverse
/// covariance times the offsets.
fn explained(covariance: DMatrix<f64>, offsets: &DVector<f64>) -> Option<(f64, DVector<f64>)> {
    let factor = covariance.cholesky()?;
    let pulls = factor.solve(offsets);
    let roots: f64 = factor.l_dirty().diagonal().iter().map(|root| root.ln()).sum();
    Some((-0.5 * offsets.dot(&pulls) - roots, pulls))
}

/// Halos, textures and the blocks of a compressed picture displace an outline along some pixels,
/// and partly all around.
fn common(segments: &[ContourSegment], alike_px: f64) -> DMatrix<f64> {
    symmetric(segments.len(), |a, b| {
        let (one, other) = (&segments[a], &segments[b]);
        let square = (one.at_px - other.at_px).length_squared() / (ALIKE_PX * ALIKE_PX);
        let same_rim = one.normal.dot(other.normal).max(0.0);
        OFFSET_PX * OFFSET_PX + alike_px * alike_px * same_rim * (-0.5 * square).exp()
    })
}

fn unit(skin: Skin<'_>, segments: &[ContourSegment], length_m: f64) -> DMatrix<f64> {
    symmetric(segments.len(), |a, b| {
        let mut sum = 0.0;
        for (one, px_per_m) in &segments[a].row {
            for (other, pull) in &segments[b].row {
                sum += px_per_m.dot(skin.carried(*one, *other, *pull, length_m));
            }
        }
        sum
    })
}

fn symmetric(n: usize, of: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    for column in 0..n {
        for row in column..n {
            let value = of(row, column);
            matrix[(row, column)] = value;
            matrix[(column, row)] = value;
        }
    }
    matrix
}

fn weights(offsets: &DVector<f64>, scale_px: f64) -> Vec<f64> {
    let weight = |offset: &f64| robust::weight((offset / scale_px).powi(2));
    offsets.iter().map(weight).collect()
}

/// Median of absolute values; 0 for an empty list.
fn median_size<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    median(values.map(|value| value.abs()), f64::total_cmp).unwrap_or(0.0)
}
