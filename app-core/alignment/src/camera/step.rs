//! Gauss-Newton steps on a camera's six numbers.

use glam::{DVec2, DVec3};

use super::brightness::Plane;
use super::points::Point;
use crate::rigid_motion::{Matrix6, RigidMotion, Vector6, step_of};
use app_scene::scene::{Camera, Intrinsics, PoseUncertainty};

/// Prior deviations of a tracker, in radians and metres: they regularise directions that the
/// texture does not constrain.
const TRACKED_RAD: f64 = 0.1;
const TRACKED_M: f64 = 0.1;
/// Turns that are tried first in all four directions: their spacing, and their number in each
/// direction.
const TURN_RAD: f64 = 0.25 * std::f64::consts::PI / 180.0;
const N_TURNS: i32 = 8;
/// Their largest number, for a camera of larger given uncertainty.
const MOST_TURNS: i32 = 24;
/// Number of the best turns from which steps are taken, besides no turn.
const N_STARTS: usize = 8;
/// Stride of the points used then.
const START_STRIDE: usize = 4;
/// Size of the last step, as a root mean square shift of points in pixels.
const LAST_STEP_PX: f64 = 1e-3;

/// One level of a photograph, and the points to be matched in it.
pub(super) struct Search<'a> {
    photograph: &'a Plane,
    intrinsics: Intrinsics,
    templates: &'a [Vec<Point>],
    robust: f64,
    uncertainty: PoseUncertainty,
}

/// A point with its matching pixel.
struct PointMatch {
    template: usize,
    /// Brightness of point and pixel.
    brightness: [f64; 2],
    /// Change of the pixel's brightness per unit of each number of a step.
    row: Vector6,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        (camera, uncertainty): (&Camera, &PoseUncertainty),
        photograph: &'a Plane,
        templates: &'a [Vec<Point>],
        robust: f64,
    ) -> Self {
        Self {
            photograph,
            intrinsics: photograph.intrinsics(&camera.intrinsics),
            templates,
            robust,
            uncertainty: *uncertainty,
        }
    }

    /// Number of all points.
    pub(super) fn n_points(&self) -> usize {
        self.templates.iter().map(Vec::len).sum()
    }

    /// No motion, and turns that improve the match: a jump of a tracker, or a shake of the hand, is
    /// a turn in the first place.
    pub(super) fn starts(&self) -> Vec<RigidMotion> {
        let n_turns = self.n_turns();
        let turns = -n_turns..=n_turns;
        let all = turns
            .clone()
            .flat_map(|up| turns.clone().map(move |side| (up, side)));
        let mut tried: Vec<(f64, RigidMotion)> = all
            .map(|(up, side)| {
                let turn = TURN_RAD * DVec3::new(f64::from(up), f64::from(side), 0.0);
                let motion = RigidMotion::about_camera(turn).within(&self.uncertainty);
                (self.loss_of(&motion, START_STRIDE), motion)
            })
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = tried.into_iter().take(N_STARTS).map(|(_, motion)| motion);
        std::iter::once(RigidMotion::about_camera(DVec3::ZERO))
            .chain(best)
            .collect()
    }

    /// Number of turns to try in each direction.
    fn n_turns(&self) -> i32 {
        let most_rad = self
            .uncertainty
            .rotation_rad
            .unwrap_or(f64::from(N_TURNS) * TURN_RAD);
        #[allow(clippy::cast_possible_truncation, reason = "bounded")]
        let n_turns = (most_rad / TURN_RAD).min(f64::from(MOST_TURNS)).ceil() as i32;
        n_turns
    }

    /// The best result from several starts.
    pub(super) fn run_from(&self, starts: &[RigidMotion], n_rounds: usize) -> RigidMotion {
        let found = starts.iter().map(|start| self.run(*start, n_rounds));
        let best = found.min_by(|a, b| self.loss(a).total_cmp(&self.loss(b)));
        best.unwrap_or(RigidMotion::about_camera(DVec3::ZERO))
    }

    /// Takes steps until they are small, `n_rounds` at most.
    pub(super) fn run(&self, mut motion: RigidMotion, n_rounds: usize) -> RigidMotion {
        for _ in 0..n_rounds {
            let before = motion;
            let Some(step) = self.step(&motion) else {
                return motion;
            };
            motion = motion.then_about_camera(&step).within(&self.uncertainty);
            if self.between_px(&before, &motion) < LAST_STEP_PX {
                break;
            }
        }
        motion
    }

    /// Mean loss of Geman and McClure over all points; a point without a pixel counts as an
    /// outlier.
    pub(super) fn loss(&self, motion: &RigidMotion) -> f64 {
        self.loss_of(motion, 1)
    }

    /// The same over every `stride`th point.
    fn loss_of(&self, motion: &RigidMotion, stride: usize) -> f64 {
        let met = self.met(motion, stride);
        let gains = self.gains(&met);
        let errors = met.iter().map(|met| {
            let relative = (self.error(met, &gains) / self.robust).powi(2);
            1.0 - relative / (1.0 + relative)
        });
        let n_points = self.n_points().div_ceil(stride).max(1) as f64;
        1.0 - errors.sum::<f64>() / n_points
    }

    /// Root mean square shift of points by a motion, in pixels of the picture.
    pub(super) fn moved_px(&self, motion: &RigidMotion) -> f64 {
        self.photograph
            .picture_px(self.between_px(&RigidMotion::about_camera(DVec3::ZERO), motion))
    }

    fn between_px(&self, a: &RigidMotion, b: &RigidMotion) -> f64 {
        let points = self.templates.iter().flatten();
        let moved = points.filter_map(|point| {
            let [a, b] = [a, b].map(|motion| self.intrinsics.pixel_of(motion.apply(point.in_camera)));
            Some((b? - a?).length_squared())
        });
        let (sum, n) = moved.fold((0.0, 0.0), |(sum, n), moved| (sum + moved, n + 1.0));
        if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 }
    }

    fn met(&self, motion: &RigidMotion, stride: usize) -> Vec<PointMatch> {
        let templates = self.templates.iter().enumerate();
        let points = templates.flat_map(|(index, points)| points.iter().map(move |point| (index, point)));
        let met = points.step_by(stride).filter_map(|(template, point)| {
            let moved = motion.apply(point.in_camera);
            let (value, gradient) = self.photograph.sample(self.intrinsics.pixel_of(moved)?)?;
            Some(PointMatch {
                template,
                brightness: [point.brightness, value],
                row: motion.row(moved, self.per_m(moved, gradient)),
            })
        });
        met.collect()
    }

    /// Change of a pixel's brightness per metre of its point's move along each axis.
    fn per_m(&self, point: DVec3, gradient: DVec2) -> DVec3 {
        let k = &self.intrinsics;
        let depth_m = -point.z;
        let (across, up) = (gradient.x * k.fx_px, -gradient.y * k.fy_px);
        DVec3::new(across, up, (across * point.x + up * point.y) / depth_m) / depth_m
    }

    /// Exposure of the photograph over that of each plate, in square roots: the median over the
    /// points.
    fn gains(&self, met: &[PointMatch]) -> Vec<f64> {
        let gain = |template: usize| {
            let of_template = met
                .iter()
                .filter(|met| met.template == template && met.brightness[0] > 0.0);
            let mut ratios: Vec<f64> = of_template
                .map(|met| met.brightness[1] / met.brightness[0])
                .collect();
            ratios.sort_by(f64::total_cmp);
            ratios.get(ratios.len() / 2).copied().unwrap_or(1.0)
        };
        (0..self.templates.len()).map(gain).collect()
    }

    fn error(&self, met: &PointMatch, gains: &[f64]) -> f64 {
        met.brightness[1] - gains[met.template] * met.brightness[0]
    }

    /// `None` if no point has a pixel.
    fn step(&self, motion: &RigidMotion) -> Option<Vector6> {
        let met = self.met(motion, 1);
        let gains = self.gains(&met);
        let turn_rad = self
            .uncertainty
            .rotation_rad
            .map_or(TRACKED_RAD, |most| most.max(TRACKED_RAD));
        let move_m = self
            .uncertainty
            .position_m
            .map_or(TRACKED_M, |most| most.max(TRACKED_M));
        let prior = step_of(DVec3::splat(turn_rad), DVec3::splat(move_m))
            .map(|deviation| (self.robust / deviation).powi(2));
        let mut information = Matrix6::from_diagonal(&prior);
        let mut gradient = -prior.component_mul(&motion.numbers());
        for met in &met {
            let error = self.error(met, &gains);
            let weight = 1.0 / (1.0 + (error / self.robust).powi(2));
            information += weight * met.row * met.row.transpose();
            gradient -= weight * error * met.row;
        }
        (!met.is_empty()).then_some(())?;
        Some(information.cholesky()?.solve(&gradient))
    }
}
