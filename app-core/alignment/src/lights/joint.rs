//! The toy's pose and the lights, estimated together from the outline's pose and the shadows.
//!
//! A shadow is a second view of the toy, from the light. The step of pose and lamps that explains the shadows best is
//! solved with the outline's pose as prior knowledge, and the light's factors eliminated. Errors of the light model are
//! alike over parts of the picture, so that the shadows count as little as the scatter between these says.

use std::collections::BTreeMap;

use glam::DMat4;
use nalgebra::{DMatrix, DVector};

use super::follow::View;
use super::lamp::{Lamp, N_PARTS};
use super::prior::Prior;
use super::shading::{FIRST_LAMP, Factors, Shaded, Shading};
use super::shadows::{LEAST_PIXELS, ROBUST_NEAR, Shadows};
use super::step::{Slope, bounded, difference_px};
use super::uncertainty::Block;
use crate::raster::Rasterizer;
use crate::rigid_motion::{Matrix6, RigidMotion, Vector6};
use crate::shape::Shape;
use app_scene::scene::{Light, LightUncertainty};

/// Number of the pose's parameters.
const N_POSE: usize = 6;
/// The level that is compared: the last of the search for lights.
const LEVEL: usize = 1;
/// Largest loss after the step, over that before.
///
/// Measured: .82 to .97 in soft and ideal pictures, .990 to .993 in a phone's, whose noise is most of the loss; steps
/// that left more than .997 changed nothing that shows.
const GAIN: f64 = 0.995;

/// A step of the toy, and the lights after it.
pub(crate) struct Joined {
    /// From camera space to camera space.
    pub(crate) motion: DMat4,
    pub(crate) lights: Vec<Light>,
}

/// The outline's knowledge of the pose.
pub(crate) struct OfOutline<'a> {
    /// Covariance of a step.
    pub(crate) covariance: &'a Matrix6,
    /// Largest evidence of the outline against a step: with more it would be undone in the next picture.
    pub(crate) most_evidence: f64,
}

/// The step of pose and lights that explains the shadows better; `None` if there is none. Lamps stay near what they
/// are, and directional ones at infinity.
pub(crate) fn joined(
    lights: &[Light],
    view: View<'_>,
    outline: &OfOutline<'_>,
    world_from_camera: &DMat4,
) -> Option<Joined> {
    let shape = view.shape;
    let of_outline = outline.covariance.cholesky()?.inverse();
    let camera_from_world = world_from_camera.inverse();
    let lamps = lights.iter();
    let lamps = lamps.map(|light| Lamp::new(light, &camera_from_world, shape.centre));
    let lamps = lamps.collect::<Option<Vec<Lamp>>>()?;
    let near = |lamp| Prior::given(lamp, &LightUncertainty::default());
    let priors: Vec<Prior> = lamps.iter().map(near).collect();
    let mut raster = Rasterizer::default();
    let level = view.pyramid.level(LEVEL);
    let mut shadows = Shadows::new(&mut raster, (shape, view.receivers), level, Some(&lamps));
    if lamps.is_empty() || !shadows.has_plate || shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let shading = shadows.shading(&mut raster, &lamps, ROBUST_NEAR);
    shadows.light(&lamps, &shading);
    let taken = shadows.taken_of_all(&mut raster, &lamps);
    let shading = shadows.shaded(&taken).fit(view.receivers.len(), ROBUST_NEAR);
    let columns = shadows.columns(&mut raster, &lamps, &priors);
    let mut system = shadows.system((&taken, &columns), &shading);
    system.hold(&lamps, &priors);
    let step = system.step(&of_outline)?;
    let of_pose = Vector6::from_iterator(step.rows(system.n_lamp_columns(), N_POSE).iter().copied());
    if 0.5 * (of_outline * of_pose).dot(&of_pose) >= outline.most_evidence {
        return None;
    }
    let known = lamps.iter().zip(&priors).enumerate();
    let moved = known.map(|(index, (lamp, prior))| {
        let part = |part| step[N_PARTS * index + part];
        lamp.moved(&bounded(
            lamp,
            prior,
            [part(0), part(1), part(2), part(3)],
            shape.radius_m,
        ))
    });
    let moved: Vec<Lamp> = moved.collect();
    let there = shadows.taken_of_shape(&mut raster, &stepped(shape, &of_pose), &moved);
    let after = shadows.shaded(&there).fit(view.receivers.len(), ROBUST_NEAR);
    (after.loss < GAIN * shading.loss).then(|| Joined {
        motion: motion(shape, &of_pose).matrix(),
        lights: moved
            .iter()
            .map(|lamp| lamp.light(world_from_camera, shape.centre))
            .collect(),
    })
}

fn motion(shape: &Shape, step: &Vector6) -> RigidMotion {
    RigidMotion::none(shape.centre, shape.radius_m).then(step)
}

/// The toy after a step; lamps stay relative to its former centre.
fn stepped(shape: &Shape, step: &Vector6) -> Shape {
    let motion = motion(shape, step);
    Shape {
        points: shape.points.iter().map(|point| motion.apply(*point)).collect(),
        ..shape.clone()
    }
}

/// Derivatives of each lamp's blocked light by one parameter; `None` for a lamp that it does not change.
type Column = Vec<Slope>;

/// The shadows' equations for lamps and pose, without the factors of the light.
struct System {
    normal: DMatrix<f64>,
    side: DVector<f64>,
    /// Weighted residuals of each part of the picture.
    scores: Vec<DVector<f64>>,
}

impl System {
    fn n_lamp_columns(&self) -> usize {
        self.side.len() - N_POSE
    }

    /// Adds the knowledge of the lamps.
    fn hold(&mut self, lamps: &[Lamp], priors: &[Prior]) {
        for (index, (lamp, prior)) in lamps.iter().zip(priors).enumerate() {
            for (part, (away, information)) in prior.pull(lamp).into_iter().enumerate() {
                let place = N_PARTS * index + part;
                self.normal[(place, place)] += information;
                self.side[place] -= information * away;
            }
        }
    }

    /// The step of lamps and pose, with the outline's information about the pose; `None` if it is unconstrained.
    fn step(&self, of_outline: &Matrix6) -> Option<DVector<f64>> {
        let first = self.n_lamp_columns();
        let of_lamps = self.normal.view((0, 0), (first, first)).into_owned().cholesky()?;
        // How the lamps follow the pose, and what is left of the pose's equations.
        let followed = of_lamps.solve(&self.normal.view((0, first), (first, N_POSE)));
        let mixed = self.normal.view((first, 0), (N_POSE, first));
        let rest = self.normal.view((first, first), (N_POSE, N_POSE)) - mixed * &followed;
        let own = |all: &DVector<f64>| all.rows(first, N_POSE) - followed.tr_mul(&all.rows(0, first));
        let scatter = self
            .scores
            .iter()
            .fold(DMatrix::zeros(N_POSE, N_POSE), |sum, score| {
                let own = own(score);
                sum + &own * own.transpose()
            });
        let rest = Matrix6::from_iterator(rest.iter().copied());
        let scatter = Matrix6::from_iterator(scatter.iter().copied());
        let alike = (rest.cholesky()?.solve(&scatter).trace() / N_POSE as f64).max(1.0);
        let side = Vector6::from_iterator(own(&self.side).iter().copied()) / alike;
        let of_pose = (of_outline + rest / alike).cholesky()?.solve(&side);
        let of_pose = DVector::from_column_slice(of_pose.as_slice());
        let lamps = of_lamps.solve(&self.side.rows(0, first)) - followed * &of_pose;
        Some(DVector::from_iterator(
            self.side.len(),
            lamps.iter().chain(of_pose.iter()).copied(),
        ))
    }
}

impl Shadows<'_> {
    /// The columns of all lamps, then those of the pose.
    fn columns(&self, raster: &mut Rasterizer, lamps: &[Lamp], priors: &[Prior]) -> Vec<Column> {
        let shape = self.caster.shape;
        let mut columns = Vec::new();
        for (index, (lamp, prior)) in lamps.iter().zip(priors).enumerate() {
            for slope in self.slopes(raster, (lamp, None), prior) {
                let mut column: Column = vec![None; lamps.len()];
                column[index] = slope;
                columns.push(column);
            }
        }
        let widest_px = lamps
            .iter()
            .map(|lamp| self.penumbra_px(lamp))
            .fold(0.0, f64::max);
        let by_m = difference_px(widest_px) / self.px_per_rad * shape.radius_m;
        for part in 0..N_POSE {
            let mut there = |by_m: f64| {
                let mut step = Vector6::zeros();
                step[part] = by_m;
                self.taken_of_shape(raster, &stepped(shape, &step), lamps)
            };
            let (more, less) = (there(by_m), there(-by_m));
            let column = more.iter().zip(&less).map(|(more, less)| {
                #[allow(clippy::cast_possible_truncation, reason = "a slope, to 7 digits")]
                let slope = |(more, less): (&f32, &f32)| (f64::from(more - less) / (2.0 * by_m)) as f32;
                Some(more.iter().zip(less).map(slope).collect())
            });
            columns.push(column.collect());
        }
        columns
    }

    fn system(&self, (taken, columns): (&[Vec<f32>], &[Column]), shading: &Shading) -> System {
        let n = columns.len();
        let shaded = self.shaded(taken);
        let mut blocks = vec![Block::new(n); 3 * shading.factors.len()];
        self.each(&shaded, columns, shading, |one| {
            blocks[one.block].add(&one.factors, one.row, one.weight);
        });
        let solved: Vec<DMatrix<f64>> = blocks.into_iter().map(Block::solved).collect();
        let (mut normal, mut side) = (DMatrix::zeros(n, n), DVector::zeros(n));
        let mut scores: BTreeMap<[i32; 2], DVector<f64>> = BTreeMap::new();
        self.each(&shaded, columns, shading, |one| {
            let own = one.row - solved[one.block].tr_mul(&one.factors);
            normal.ger(one.weight, &own, &own, 1.0);
            side.axpy(one.weight * one.residual, &own, 1.0);
            let score = scores.entry(self.tile(self.pixels[one.pixel].at));
            let score = score.or_insert_with(|| DVector::zeros(n));
            score.axpy(one.weight * one.residual, &own, 1.0);
        });
        System {
            normal,
            side,
            scores: scores.into_values().collect(),
        }
    }

    fn each(
        &self,
        shaded: &Shaded<'_>,
        columns: &[Column],
        shading: &Shading,
        mut visit: impl FnMut(&Observation<'_>),
    ) {
        let mut row = DVector::zeros(columns.len());
        for (pixel, seen) in self.pixels.iter().enumerate() {
            let taken = shaded.columns(pixel);
            for channel in 0..3 {
                let factors = &shading.factors[seen.receiver][channel];
                let Some(one) = shaded.residual((pixel, channel), &taken, factors, ROBUST_NEAR) else {
                    continue;
                };
                let plate = f64::from(seen.plate[channel]);
                for (value, column) in row.iter_mut().zip(columns) {
                    let slopes = column.iter().enumerate();
                    let slopes = slopes.filter_map(|(lamp, slope)| Some((lamp, slope.as_ref()?[pixel])));
                    *value = slopes
                        .map(|(lamp, slope)| -plate * factors[FIRST_LAMP + lamp] * f64::from(slope))
                        .sum();
                }
                visit(&Observation {
                    block: 3 * seen.receiver + channel,
                    pixel,
                    factors: one.row,
                    row: &row,
                    weight: one.weight,
                    residual: one.residual,
                });
            }
        }
    }
}

/// One channel of a pixel.
struct Observation<'a> {
    /// Index of its receiver and channel.
    block: usize,
    pixel: usize,
    /// Its derivatives by the factors of the light.
    factors: Factors,
    /// By lamps and pose.
    row: &'a DVector<f64>,
    weight: f64,
    residual: f64,
}
