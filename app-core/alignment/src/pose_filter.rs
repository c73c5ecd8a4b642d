//! Filters the noise of a tracker from a pose that is static, drifts slowly and sometimes jumps.

use glam::{DMat3, DMat4, DQuat, DVec3};

use app_scene::scene::check;

/// Random walk of the pose itself: standard deviation per second along each axis, in metres.
const DRIFT_M: f64 = 5e-4;
/// The same about each axis, in radians.
const DRIFT_RAD: f64 = 1e-3;
/// Sum of six squared standardised deviations that chance exceeds once in ten thousand times (chi
/// squared).
const UNLIKELY: f64 = 27.9;
/// The same, once in ten million times.
const IMPOSSIBLE: f64 = 43.0;
/// Largest number of successive measurements that can indicate a jump; two are the smallest.
const N_LATEST: usize = 5;
/// Bounds of the estimated noise, over the stated one.
const NOISE_RATIO: [f64; 2] = [0.1, 10.0];
/// Initial weight of the stated noise, in differences.
const N_STATED: f64 = 20.0;
/// Number of differences over which the noise is averaged: some ten seconds.
const N_AVERAGED: f64 = 200.0;
/// Largest ratio of a squared difference to its expectation, since a jump's says nothing about
/// noise.
const MAX_SURPRISE: f64 = 4.0;
/// Range of stated noise, in metres and in radians.
const STATED: [f64; 2] = [1e-6, 1.0];

/// Standard deviation of one measurement along and about each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNoise {
    /// Metres, 1e-6 to 1.
    pub position_m: f64,
    /// Radians, 1e-6 to 1.
    pub rotation_rad: f64,
}

impl Default for PoseNoise {
    /// The noise of a phone's tracker: 1 mm and .2 degrees.
    fn default() -> Self {
        Self {
            position_m: 1e-3,
            rotation_rad: 0.2_f64.to_radians(),
        }
    }
}

/// The result for a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseStep {
    /// The first measurement.
    Began,
    /// The measurement was used.
    Followed,
    /// The measurement was too far off, and is ignored unless the next ones agree with it.
    Doubted,
    /// Several successive measurements agreed on another pose, from which the filter continues.
    Jumped,
    /// There was no measurement, or no valid one: the pose stays.
    Held,
}

/// Filters a pose, for example the toy's in the world, from measurements that are noisy or missing.
///
/// A Kalman filter whose state walks at random, with a gate: a measurement that is too far off
/// waits until others agree with it. Two to five in a row that do are a jump, and the filter
/// restarts from their mean, so that no pose between two places is shown. The noise need not be
/// known well: it is estimated from differences between frames, within a tenth and ten times of the
/// stated noise.
///
/// Measured by `tests/tests/estimates/pose_filter.rs`, frames 17, 33 and 50 ms apart by chance,
/// under white noise of 1 mm and .2 degrees along and about each axis. Lag is that behind a pose
/// that goes 1 mm in a second; a jump of 10 mm and 1 degree has settled once the pose stays within
/// 2 mm; the last row has a drift of 2 mm in half a minute, jumps every few seconds, dropouts of .1
/// to 2 s and one measurement in a hundred 20 mm astray:
///
/// | | as measured | exponential, .2 s | One Euro, .2 Hz | this |
/// | --- | --- | --- | --- | --- |
/// | jitter at rest, RMS | 1.73 mm, .35 deg | .53 mm, .11 deg | .43 mm, .09 deg | .37 mm, .06 deg |
/// | lag | 0 ms | 178 ms | 240 ms | 345 ms |
/// | settled after a jump: median, 19 of 20 | never | 301, 382 ms | 150, 200 ms | 50, 150 ms |
/// | distance from the truth: median, 19 of 20 | 1.54, 2.87 mm | .61, 3.76 mm | .55, 3.85 mm | .48, 1.02 mm |
///
/// With a fifth of the noise, as alignment leaves, it is .15 mm, .02 deg, 67 ms, 50 and 50 ms, .16
/// and .31 mm. With three times of it .65 mm, .10 deg and 1.06 s: there a jump of 10 mm takes 267
/// ms in the median and 1.5 s in one of twenty.
///
/// Source: Kalman 1960; the gate as Bar-Shalom and Fortmann 1988.
#[derive(Clone, Debug)]
pub struct PoseFilter {
    stated: Variance,
    /// The estimated noise.
    noise: Variance,
    n_differences: f64,
    pivot: DVec3,
    estimate: Option<Estimate>,
    /// Successive measurements without a gap, the last one last.
    latest: Vec<Pose>,
}

#[derive(Clone, Copy, Debug)]
struct Pose {
    /// Position of the pivot.
    position: DVec3,
    rotation: DQuat,
    scale: f64,
}

/// Variance of a pose or of a measurement, along and about each axis; squares of metres and of
/// radians.
#[derive(Clone, Copy, Debug)]
struct Variance {
    position: f64,
    rotation: f64,
}

#[derive(Clone, Copy, Debug)]
struct Estimate {
    pose: Pose,
    variance: Variance,
}

impl PoseFilter {
    /// A filter for measurements with about the given noise. The pivot is the relevant point in the
    /// space that the pose leads from: the origin for a toy's pose, the toy's place for a
    /// correction of the tracker's whole world.
    #[must_use]
    pub fn new(noise: PoseNoise, pivot: DVec3) -> Self {
        let [position, rotation] = [noise.position_m, noise.rotation_rad].map(|stated| {
            // NaN fails the comparison, too.
            let stated = if stated > STATED[0] {
                stated.min(STATED[1])
            } else {
                STATED[0]
            };
            stated * stated
        });
        let stated = Variance { position, rotation };
        Self {
            stated,
            noise: stated,
            n_differences: N_STATED,
            pivot,
            estimate: None,
            latest: Vec::with_capacity(N_LATEST),
        }
    }

    /// Advances by a frame, `elapsed_s` seconds after the last one: with the measured pose, a
    /// rotation, a translation and a scale, or without a measurement. The scale is not filtered.
    pub fn step(&mut self, elapsed_s: f64, measured: Option<DMat4>) -> PoseStep {
        if let Some(estimate) = &mut self.estimate
            && elapsed_s > 0.0
            && elapsed_s.is_finite()
        {
            estimate.variance.position += DRIFT_M * DRIFT_M * elapsed_s;
            estimate.variance.rotation += DRIFT_RAD * DRIFT_RAD * elapsed_s;
        }
        let Some(measured) = measured.and_then(|pose| self.parts(pose)) else {
            self.latest.clear();
            return PoseStep::Held;
        };
        let Some(estimate) = self.estimate else {
            self.estimate = Some(Estimate {
                pose: measured,
                variance: self.noise,
            });
            return PoseStep::Began;
        };
        self.learn_noise(&measured);
        if self.latest.len() == N_LATEST {
            self.latest.remove(0);
        }
        self.latest.push(measured);
        if let Some(elsewhere) = self.elsewhere(&estimate) {
            self.estimate = Some(elsewhere);
            self.latest.clear();
            return PoseStep::Jumped;
        }
        let expected = estimate.variance + self.noise;
        if deviation(&estimate.pose, &measured, &expected) > UNLIKELY {
            return PoseStep::Doubted;
        }
        let gain = [
            estimate.variance.position / expected.position,
            estimate.variance.rotation / expected.rotation,
        ];
        self.estimate = Some(Estimate {
            pose: blended(&estimate.pose, &measured, gain),
            variance: Variance {
                position: gain[0] * self.noise.position,
                rotation: gain[1] * self.noise.rotation,
            },
        });
        PoseStep::Followed
    }

    /// The pose, after the first measurement.
    #[must_use]
    pub fn pose(&self) -> Option<DMat4> {
        let Pose {
            position,
            rotation,
            scale,
        } = self.estimate?.pose;
        let linear = DMat3::from_quat(rotation) * scale;
        Some(DMat4::from_mat3_translation(
            linear,
            position - linear * self.pivot,
        ))
    }

    /// Forgets the pose, for example when the tracker begins a new world, but not the noise.
    pub fn forget(&mut self) {
        self.estimate = None;
        self.latest.clear();
    }

    fn learn_noise(&mut self, measured: &Pose) {
        let Some(before) = self.latest.last() else {
            return;
        };
        self.n_differences = (self.n_differences + 1.0).min(N_AVERAGED);
        let found = |noise: f64, stated: f64, difference: DVec3| {
            // Three axes, each with the noise of two measurements.
            let found = (difference.length_squared() / 6.0).min(MAX_SURPRISE * noise);
            let [least, most] = NOISE_RATIO.map(|ratio| ratio * ratio * stated);
            (noise + (found - noise) / self.n_differences).clamp(least, most)
        };
        let moved = measured.position - before.position;
        let turned = turn(before.rotation, measured.rotation);
        self.noise = Variance {
            position: found(self.noise.position, self.stated.position, moved),
            rotation: found(self.noise.rotation, self.stated.rotation, turned),
        };
    }

    fn parts(&self, pose: DMat4) -> Option<Pose> {
        let pose = check::similarity(pose.to_cols_array()).ok()?;
        let axes = DMat3::from_mat4(pose);
        let scale = axes.determinant().cbrt();
        let position = pose.transform_point3(self.pivot);
        position.is_finite().then(|| Pose {
            position,
            rotation: DQuat::from_mat3(&(axes * scale.recip())).normalize(),
            scale,
        })
    }

    /// Another pose on which the latest measurements agree, using as few of them as possible.
    fn elsewhere(&self, estimate: &Estimate) -> Option<Estimate> {
        let (last, before) = self.latest.split_last()?;
        let mut mean = *last;
        let mut n = 1.0;
        for (first, measured) in before.iter().enumerate().rev() {
            n += 1.0;
            mean = blended(&mean, measured, [1.0 / n; 2]);
            let mut all = self.latest.iter().skip(first);
            if !all.all(|measured| deviation(&mean, measured, &self.noise) < UNLIKELY) {
                return None;
            }
            let variance = Variance {
                position: self.noise.position / n,
                rotation: self.noise.rotation / n,
            };
            if deviation(&estimate.pose, &mean, &(estimate.variance + variance)) > IMPOSSIBLE {
                return Some(Estimate { pose: mean, variance });
            }
        }
        None
    }
}

impl std::ops::Add for Variance {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            position: self.position + other.position,
            rotation: self.rotation + other.rotation,
        }
    }
}

/// Squared distance of two poses, each axis over its standard deviation.
fn deviation(one: &Pose, other: &Pose, expected: &Variance) -> f64 {
    let turned = turn(one.rotation, other.rotation);
    one.position.distance_squared(other.position) / expected.position
        + turned.length_squared() / expected.rotation
}

/// The shorter rotation from one to another: axis times angle, in radians.
fn turn(from: DQuat, to: DQuat) -> DVec3 {
    let turn = from.inverse() * to;
    (if turn.w < 0.0 { -turn } else { turn }).to_scaled_axis()
}

/// Interpolates position and rotation by the given fractions.
fn blended(from: &Pose, to: &Pose, [moved, turned]: [f64; 2]) -> Pose {
    let turn = DQuat::from_scaled_axis(turned * turn(from.rotation, to.rotation));
    Pose {
        position: from.position.lerp(to.position, moved),
        rotation: (from.rotation * turn).normalize(),
        scale: to.scale,
    }
}
