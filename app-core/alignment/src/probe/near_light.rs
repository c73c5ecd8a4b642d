//! Where a near light is, by rays of several views: the point that is nearest to all of them.

use glam::{DMat3, DVec3};

/// Rays agree where they miss each other by no more deviations.
const MISSED: f64 = 3.0;
/// A distance is told by as many deviations of itself.
const TOLD: f64 = 3.0;
/// Rounds of weights that follow from the distances.
const N_ROUNDS: usize = 3;
/// Normal equations of rays that are parallel to rounding, as their determinant over that of even ones.
const SINGULAR: f64 = 1e-15;

/// A ray to a light, in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) origin: DVec3,
    /// Unit.
    pub(super) direction: DVec3,
    /// One deviation of the direction, in radians.
    pub(super) deviation_rad: f64,
}

/// Where rays meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    pub(super) position: DVec3,
    /// From the first ray's origin, in metres.
    pub(super) distance_m: f64,
    /// One deviation of one over that, in 1/m.
    pub(super) nearness_deviation_per_m: f64,
}

impl Meeting {
    /// Whether it is nearer than infinity by more than noise.
    pub(super) fn is_told(&self) -> bool {
        TOLD * self.nearness_deviation_per_m * self.distance_m < 1.0
    }
}

/// Whether two rays can be of one light: parallel or crossing before both, as far as their deviations tell.
pub(super) fn agree(a: &Ray, b: &Ray) -> bool {
    let between_rad = a.direction.angle_between(b.direction);
    if between_rad <= MISSED * a.deviation_rad.hypot(b.deviation_rad) {
        return true;
    }
    // The nearest points of two lines. Their directions are not parallel by now.
    let (offset, cosine) = (b.origin - a.origin, a.direction.dot(b.direction));
    let sine_squared = 1.0 - cosine * cosine;
    if sine_squared <= 0.0 {
        return false;
    }
    let [along_a, along_b] = [a.direction, b.direction].map(|direction| offset.dot(direction));
    let at_a = (along_a - cosine * along_b) / sine_squared;
    let at_b = (cosine * along_a - along_b) / sine_squared;
    let miss_m = (offset + at_b * b.direction - at_a * a.direction).length();
    at_a > 0.0 && at_b > 0.0 && miss_m <= MISSED * (a.deviation_rad * at_a).hypot(b.deviation_rad * at_b)
}

/// The point nearest to rays, each counted by what its deviation makes of its distance: least squares. None for less than two,
/// for parallel ones, and where it lies behind one of them.
pub(super) fn meet(rays: &[Ray]) -> Option<Meeting> {
    let first = rays.first()?;
    let mut distances_m = vec![1.0; rays.len()];
    let mut solved = None;
    for _ in 0..N_ROUNDS {
        let (mut normal, mut side) = (DMat3::ZERO, DVec3::ZERO);
        for (ray, distance_m) in rays.iter().zip(&distances_m) {
            let d = ray.direction;
            let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            let weight = (ray.deviation_rad * distance_m).powi(-2);
            normal += weight * across;
            // From the first origin, so that a world far away costs no digits.
            side += weight * (across * (ray.origin - first.origin));
        }
        let even = (normal.x_axis.x + normal.y_axis.y + normal.z_axis.z) / 3.0;
        let determinant = normal.determinant();
        if determinant.is_nan() || determinant <= SINGULAR * even.powi(3) {
            return None;
        }
        let covariance = normal.inverse();
        let from_first = covariance * side;
        for (ray, distance_m) in rays.iter().zip(&mut distances_m) {
            *distance_m = (first.origin + from_first - ray.origin).dot(ray.direction);
            if distance_m.is_nan() || *distance_m <= 0.0 {
                return None;
            }
        }
        solved = Some((from_first, covariance));
    }
    let (from_first, covariance) = solved?;
    let distance_m = *distances_m.first()?;
    let variance_m2 = first.direction.dot(covariance * first.direction).max(0.0);
    let meeting = Meeting {
        position: first.origin + from_first,
        distance_m,
        nearness_deviation_per_m: variance_m2.sqrt() / (distance_m * distance_m),
    };
    (meeting.position.is_finite() && meeting.nearness_deviation_per_m.is_finite()).then_some(meeting)
}
