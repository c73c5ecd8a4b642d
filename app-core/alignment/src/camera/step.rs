//! Gauss-Newton steps on a camera's six numbers.

use glam::{DMat4, DQuat, DVec2, DVec3};
use nalgebra::{SMatrix, SVector};

use super::brightness::Plane;
use super::points::Point;
use app_scene::scene::{Camera, Intrinsics, PoseUncertainty};

type Vector6 = SVector<f64, 6>;
type Matrix6 = SMatrix<f64, 6, 6>;

/// What a tracker is never off by, in radians and metres: holds back what the texture does not tell.
const TRACKED_RAD: f64 = 0.1;
const TRACKED_M: f64 = 0.1;
/// Turns that are tried first, up and down and to either side: how far apart, and how many in each direction.
const TURN_RAD: f64 = 0.25 * std::f64::consts::PI / 180.0;
const N_TURNS: i32 = 8;
/// The same at most, where a camera is said to be turned by more.
const MOST_TURNS: i32 = 24;
/// The best of them from which steps are taken, beside no turn.
const N_STARTS: usize = 8;
/// Every how many points are looked at then.
const START_STRIDE: usize = 4;
/// Steps that move points by less, in root mean square pixels, are the last.
const LAST_STEP_PX: f64 = 1e-3;

/// A rotation about the camera, then a translation, of points in camera space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rigid {
    rotation: DQuat,
    translation: DVec3,
}

impl Default for Rigid {
    fn default() -> Self {
        Self {
            rotation: DQuat::IDENTITY,
            translation: DVec3::ZERO,
        }
    }
}

impl Rigid {
    pub(super) fn matrix(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.rotation, self.translation)
    }

    pub(super) fn moved_m(&self) -> f64 {
        self.translation.length()
    }

    pub(super) fn turned_rad(&self) -> f64 {
        self.rotation.to_scaled_axis().length()
    }

    fn apply(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    fn then(&self, step: &Vector6) -> Self {
        let turn = DQuat::from_scaled_axis(DVec3::new(step[0], step[1], step[2]));
        Self {
            rotation: (turn * self.rotation).normalize(),
            translation: turn * self.translation + DVec3::new(step[3], step[4], step[5]),
        }
    }

    /// The nearest motion that goes no farther than a pose is uncertain.
    fn within(self, uncertainty: &PoseUncertainty) -> Self {
        let mut within = self;
        if let Some(most_m) = uncertainty.position_m {
            within.translation = within.translation.clamp_length_max(most_m);
        }
        let turn = within.rotation.to_scaled_axis();
        if let Some(most_rad) = uncertainty
            .rotation_rad
            .filter(|most_rad| turn.length() > *most_rad)
        {
            within.rotation = DQuat::from_scaled_axis(turn.clamp_length_max(most_rad));
        }
        within
    }

    /// As numbers: rotation vector, then translation.
    fn numbers(&self) -> Vector6 {
        let (turn, shift) = (self.rotation.to_scaled_axis(), self.translation);
        Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
    }
}

/// One level of a photograph, and the points to be found in it.
pub(super) struct Search<'a> {
    photograph: &'a Plane,
    intrinsics: Intrinsics,
    templates: &'a [Vec<Point>],
    robust: f64,
    uncertainty: PoseUncertainty,
}

/// A point that meets a pixel.
struct Met {
    template: usize,
    /// Point and pixel.
    brightness: [f64; 2],
    /// Change of the pixel's brightness for each number of a step.
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

    /// Points in all.
    pub(super) fn n_points(&self) -> usize {
        self.templates.iter().map(Vec::len).sum()
    }

    /// No motion, and turns that bring the picture nearer: a tracker that jumps, or a hand that shakes, turns the camera more than it
    /// shows otherwise.
    pub(super) fn starts(&self) -> Vec<Rigid> {
        let n_turns = self.n_turns();
        let turns = -n_turns..=n_turns;
        let all = turns
            .clone()
            .flat_map(|up| turns.clone().map(move |side| (up, side)));
        let mut tried: Vec<(f64, Rigid)> = all
            .map(|(up, side)| {
                let turn = TURN_RAD * DVec3::new(f64::from(up), f64::from(side), 0.0);
                let motion = Rigid {
                    rotation: DQuat::from_scaled_axis(turn),
                    ..Rigid::default()
                };
                let motion = motion.within(&self.uncertainty);
                (self.loss_of(&motion, START_STRIDE), motion)
            })
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = tried.into_iter().take(N_STARTS).map(|(_, motion)| motion);
        std::iter::once(Rigid::default()).chain(best).collect()
    }

    /// Of turns to try in each direction.
    fn n_turns(&self) -> i32 {
        let most_rad = self
            .uncertainty
            .rotation_rad
            .unwrap_or(f64::from(N_TURNS) * TURN_RAD);
        #[allow(clippy::cast_possible_truncation, reason = "bounded")]
        let n_turns = (most_rad / TURN_RAD).min(f64::from(MOST_TURNS)).ceil() as i32;
        n_turns
    }

    /// The best of what is found from several starts.
    pub(super) fn run_from(&self, starts: &[Rigid], n_rounds: usize) -> Rigid {
        let found = starts.iter().map(|start| self.run(*start, n_rounds));
        let best = found.min_by(|a, b| self.loss(a).total_cmp(&self.loss(b)));
        best.unwrap_or_default()
    }

    /// Steps until they are small, `n_rounds` at most.
    pub(super) fn run(&self, mut motion: Rigid, n_rounds: usize) -> Rigid {
        for _ in 0..n_rounds {
            let before = motion;
            let Some(step) = self.step(&motion) else {
                return motion;
            };
            motion = motion.then(&step).within(&self.uncertainty);
            if self.between_px(&before, &motion) < LAST_STEP_PX {
                break;
            }
        }
        motion
    }

    /// Mean loss of Geman and McClure over all points; one that meets no pixel counts as far off.
    pub(super) fn loss(&self, motion: &Rigid) -> f64 {
        self.loss_of(motion, 1)
    }

    /// The same of every `stride`th point.
    fn loss_of(&self, motion: &Rigid, stride: usize) -> f64 {
        let met = self.met(motion, stride);
        let gains = self.gains(&met);
        let errors = met.iter().map(|met| {
            let relative = (self.error(met, &gains) / self.robust).powi(2);
            1.0 - relative / (1.0 + relative)
        });
        #[allow(clippy::cast_precision_loss, reason = "points of a picture")]
        let n_points = self.n_points().div_ceil(stride).max(1) as f64;
        1.0 - errors.sum::<f64>() / n_points
    }

    /// Root mean square that a motion moves points by, in pixels of the picture.
    pub(super) fn moved_px(&self, motion: &Rigid) -> f64 {
        self.photograph
            .picture_px(self.between_px(&Rigid::default(), motion))
    }

    fn between_px(&self, a: &Rigid, b: &Rigid) -> f64 {
        let points = self.templates.iter().flatten();
        let moved = points.filter_map(|point| {
            let [a, b] = [a, b].map(|motion| self.intrinsics.pixel_of(motion.apply(point.in_camera)));
            Some((b? - a?).length_squared())
        });
        let (sum, n) = moved.fold((0.0, 0.0), |(sum, n), moved| (sum + moved, n + 1.0));
        if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 }
    }

    fn met(&self, motion: &Rigid, stride: usize) -> Vec<Met> {
        let templates = self.templates.iter().enumerate();
        let points = templates.flat_map(|(index, points)| points.iter().map(move |point| (index, point)));
        let met = points.step_by(stride).filter_map(|(template, point)| {
            let moved = motion.apply(point.in_camera);
            let (value, gradient) = self.photograph.sample(self.intrinsics.pixel_of(moved)?)?;
            Some(Met {
                template,
                brightness: [point.brightness, value],
                row: self.row(moved, gradient),
            })
        });
        met.collect()
    }

    fn row(&self, point: DVec3, gradient: DVec2) -> Vector6 {
        let k = &self.intrinsics;
        let depth_m = -point.z;
        let (across, up) = (gradient.x * k.fx_px, -gradient.y * k.fy_px);
        let per_m = DVec3::new(across, up, (across * point.x + up * point.y) / depth_m) / depth_m;
        let turn = point.cross(per_m);
        Vector6::new(turn.x, turn.y, turn.z, per_m.x, per_m.y, per_m.z)
    }

    /// Exposure of the photograph over that of each plate, in square roots: the median over the points.
    fn gains(&self, met: &[Met]) -> Vec<f64> {
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

    fn error(&self, met: &Met, gains: &[f64]) -> f64 {
        met.brightness[1] - gains[met.template] * met.brightness[0]
    }

    /// None where nothing is met.
    fn step(&self, motion: &Rigid) -> Option<Vector6> {
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
        let prior = Vector6::new(turn_rad, turn_rad, turn_rad, move_m, move_m, move_m)
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
