//! Uncertainty of lamps.
//!
//! Errors of the model are correlated over many pixels, so that noise alone would underestimate it
//! ten to a hundred times. Each tile of the picture counts as one measurement with its own error:
//! the cluster-robust covariance. Source: Liang and Zeger 1986. The uncertainty of the toy's pose
//! is added.

use std::collections::BTreeMap;

use glam::{DMat4, DQuat, DVec3, IVec2};
use nalgebra::{DMatrix, DVector};

use super::lamp::{Lamp, N_PARTS};
use super::prior::Prior;
use super::shading::{FIRST_LAMP, Factors, N_FACTORS, PRIOR, Shaded};
use super::shadows::Shadows;
use super::step::Slope;
use crate::raster::Rasterizer;
use crate::receivers::up;
use crate::report::PoseDeviation;
use crate::shape::Shape;

/// Side of a tile, over the toy's radius.
const TILE: f64 = 0.5;
/// Smallest side of a tile, in pixels.
const LEAST_TILE_PX: f64 = 4.0;

/// Residuals are correlated beyond a tile: ratio of the standard deviation to that of independent
/// tiles.
const BEYOND_TILES: f64 = 2.0;
/// Standard deviation of a receiver's height, over the toy's radius: a sheet of paper under a toy
/// of 10 cm.
const FLATNESS: f64 = 1e-3;

/// Derivatives of the blocked light by the parameters of lamps and pose.
struct Changes {
    /// For each parameter of each lamp.
    of_lamps: Vec<Slope>,
    /// For each parameter of the pose, lamp by lamp.
    of_pose: Vec<Vec<Vec<f32>>>,
}

impl Changes {
    fn n_columns(&self) -> usize {
        self.of_lamps.len() + self.of_pose.len()
    }

    /// Change of a pixel's brightness over the plate, lamps first.
    fn row(&self, pixel: usize, factors: &Factors) -> DVector<f64> {
        let of_lamps = self.of_lamps.iter().enumerate().map(|(place, slope)| {
            let slope = slope.as_ref().map_or(0.0, |slope| f64::from(slope[pixel]));
            -factors[FIRST_LAMP + place / N_PARTS] * slope
        });
        let of_pose = self.of_pose.iter().map(|change| {
            let lamps = change.iter().enumerate();
            let sum: f64 = lamps
                .map(|(lamp, change)| factors[FIRST_LAMP + lamp] * f64::from(change[pixel]))
                .sum();
            -sum
        });
        DVector::from_iterator(self.n_columns(), of_lamps.chain(of_pose))
    }
}

/// One channel of a pixel.
struct Observation {
    /// Index of its receiver and channel.
    block: usize,
    pixel: usize,
    /// Change of its brightness per unit of each parameter of lamps and pose.
    row: DVector<f64>,
    weight: f64,
    residual: f64,
}

/// Normal equations of the factors of one receiver and channel.
#[derive(Clone)]
pub(super) struct Block {
    normal: DMatrix<f64>,
    /// Mixed terms of factors and of lamps and pose.
    mixed: DMatrix<f64>,
}

impl Block {
    pub(super) fn new(n_columns: usize) -> Self {
        Self {
            normal: DMatrix::identity(N_FACTORS, N_FACTORS) * PRIOR,
            mixed: DMatrix::zeros(N_FACTORS, n_columns),
        }
    }

    /// Adds a residual by its derivatives by the factors, and by lamps and pose.
    pub(super) fn add(&mut self, factors: &Factors, row: &DVector<f64>, weight: f64) {
        self.normal.ger(weight, factors, factors, 1.0);
        self.mixed.ger(weight, factors, row, 1.0);
    }

    /// The factors' compensation for a change of each column.
    pub(super) fn solved(self) -> DMatrix<f64> {
        let Self { normal, mixed } = self;
        let n_columns = mixed.ncols();
        normal.cholesky().map_or_else(
            || DMatrix::zeros(N_FACTORS, n_columns),
            |factor| factor.solve(&mixed),
        )
    }
}

impl Shadows<'_> {
    /// Covariance of all parameters of all lamps; `None` if they are unconstrained.
    pub(super) fn covariance(
        &self,
        raster: &mut Rasterizer,
        lamps: &[Lamp],
        pose: &PoseDeviation,
        robust: f64,
    ) -> Option<DMatrix<f64>> {
        let radius_m = self.caster.shape.radius_m;
        let taken = self.taken_of_all(raster, lamps);
        let changes = Changes {
            of_lamps: lamps
                .iter()
                .flat_map(|lamp| self.slopes(raster, (lamp, None), &Prior::free(lamp, radius_m)))
                .collect(),
            of_pose: self.moved_by_pose(raster, lamps, pose, &taken),
        };
        let shaded = self.shaded(&taken);
        let (observations, blocks) = self.observations(&shaded, &changes, robust);
        let solved: Vec<DMatrix<f64>> = blocks.into_iter().map(Block::solved).collect();
        let n_columns = changes.n_columns();
        let mut normal = DMatrix::<f64>::zeros(n_columns, n_columns);
        let mut tiles: BTreeMap<[i32; 2], DVector<f64>> = BTreeMap::new();
        for one in observations {
            let pixel = &self.pixels[one.pixel];
            let columns = shaded.columns(one.pixel) * f64::from(pixel.plate[one.block % 3]);
            let made_up = solved[one.block].tr_mul(&DVector::from_column_slice(columns.as_slice()));
            let own = one.row - made_up;
            normal.ger(one.weight, &own, &own, 1.0);
            let score = tiles
                .entry(self.tile(pixel.at))
                .or_insert_with(|| DVector::zeros(n_columns));
            score.axpy(one.weight * one.residual, &own, 1.0);
        }
        sandwich(&normal, tiles.values(), changes.of_lamps.len())
    }

    fn observations(
        &self,
        shaded: &Shaded,
        changes: &Changes,
        robust: f64,
    ) -> (Vec<Observation>, Vec<Block>) {
        let n_receivers = self.caster.receivers.len();
        let shading = shaded.fit(n_receivers, robust);
        let mut observations = Vec::new();
        let mut blocks = vec![Block::new(changes.n_columns()); 3 * n_receivers];
        for (index, pixel) in self.pixels.iter().enumerate() {
            let columns = shaded.columns(index);
            for channel in 0..3 {
                let factors = &shading.factors[pixel.receiver][channel];
                let Some(one) = shaded.residual((index, channel), &columns, factors, robust) else {
                    continue;
                };
                let row = changes.row(index, factors) * f64::from(pixel.plate[channel]);
                let block = 3 * pixel.receiver + channel;
                blocks[block].add(&one.row, &row, one.weight);
                observations.push(Observation {
                    block,
                    pixel: index,
                    row,
                    weight: one.weight,
                    residual: one.residual,
                });
            }
        }
        (observations, blocks)
    }

    /// The part of the picture at a pixel, within which errors are alike.
    pub(super) fn tile(&self, at: IVec2) -> [i32; 2] {
        let side_px = (TILE * self.px_per_rad).max(LEAST_TILE_PX);
        (at.as_dvec2() / side_px).floor().as_ivec2().to_array()
    }

    /// The change of each lamp's blocked light for a move of the pose by one standard deviation of
    /// each of its parameters.
    fn moved_by_pose(
        &self,
        raster: &mut Rasterizer,
        lamps: &[Lamp],
        pose: &PoseDeviation,
        taken: &[Vec<f32>],
    ) -> Vec<Vec<Vec<f32>>> {
        let lateral_m = pose.lateral_m / 2f64.sqrt();
        let rotation_rad = pose.rotation_rad / 3f64.sqrt();
        let shape = self.caster.shape;
        let about = |rotation: DQuat| {
            DMat4::from_translation(shape.centre)
                * DMat4::from_quat(rotation)
                * DMat4::from_translation(-shape.centre)
        };
        let up = up(self.caster.receivers);
        let motions = [
            DMat4::from_translation(FLATNESS * shape.radius_m * up),
            DMat4::from_translation(lateral_m * DVec3::X),
            DMat4::from_translation(lateral_m * DVec3::Y),
            DMat4::from_translation(pose.depth_m * DVec3::Z),
            about(DQuat::from_rotation_x(rotation_rad)),
            about(DQuat::from_rotation_y(rotation_rad)),
            about(DQuat::from_rotation_z(rotation_rad)),
        ];
        motions
            .iter()
            .map(|motion| {
                let moved = Shape {
                    points: shape
                        .points
                        .iter()
                        .map(|point| motion.transform_point3(*point))
                        .collect(),
                    ..shape.clone()
                };
                let there = self.taken_of_shape(raster, &moved, lamps);
                there
                    .iter()
                    .zip(taken)
                    .map(|(there, here)| there.iter().zip(here).map(|(there, here)| there - here).collect())
                    .collect()
            })
            .collect()
    }
}

/// Covariance of the first `n_parts` columns: that of the tiles' scores, and that of one standard
/// deviation of each other column.
fn sandwich<'a>(
    normal: &DMatrix<f64>,
    scores: impl Iterator<Item = &'a DVector<f64>>,
    n_parts: usize,
) -> Option<DMatrix<f64>> {
    let mut of_lamps = normal.view((0, 0), (n_parts, n_parts)).into_owned();
    // An unconstrained parameter has no slope.
    let unconstrained: Vec<usize> = (0..n_parts)
        .filter(|part| of_lamps[(*part, *part)] <= 0.0)
        .collect();
    for part in &unconstrained {
        of_lamps[(*part, *part)] = 1.0;
    }
    let inverse = of_lamps.cholesky()?.inverse();
    let mut spread = DMatrix::<f64>::zeros(n_parts, n_parts);
    for score in scores {
        let score = score.rows(0, n_parts);
        spread += score * score.transpose();
    }
    let mut covariance = &inverse * spread * &inverse * (BEYOND_TILES * BEYOND_TILES);
    for place in n_parts..normal.ncols() {
        let by_pose = &inverse * normal.view((0, place), (n_parts, 1));
        covariance += &by_pose * by_pose.transpose();
    }
    for part in unconstrained {
        covariance[(part, part)] = f64::INFINITY;
    }
    Some(covariance)
}
