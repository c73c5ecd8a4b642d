//! The position of a near light from rays of several views: the point nearest to all of them.

use glam::{DMat3, DVec3};

/// Largest distance of agreeing rays, in standard deviations.
const MISSED: f64 = 3.0;
/// Significance of a distance, in standard deviations.
const SIGNIFICANT: f64 = 3.0;
/// Number of rounds in which weights are updated by the distances.
const N_ROUNDS: usize = 3;
/// Determinant of the normal equations of numerically parallel rays, over that of evenly spread
/// ones.
const SINGULAR: f64 = 1e-15;

/// A ray to a light, in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) origin: DVec3,
    /// Unit vector.
    pub(super) direction: DVec3,
    /// Standard deviation of the direction, in radians.
    pub(super) deviation_rad: f64,
}

/// The intersection of rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    pub(super) position: DVec3,
    /// Distance from the first ray's origin, in metres.
    pub(super) distance_m: f64,
    /// Standard deviation of the inverse distance, in 1/m.
    pub(super) nearness_deviation_per_m: f64,
}

impl Meeting {
    /// Whether it is significantly nearer than infinity.
    pub(super) fn is_significant(&self) -> bool {
        SIGNIFICANT * self.nearness_deviation_per_m * self.distance_m < 1.0
    }
}

/// Whether two rays can belong to one light: parallel or crossing in front of both, within their
/// deviations.
pub(super) fn agree(a: &Ray, b: &Ray) -> bool {
    let between_rad = a.direction.angle_between(b.direction);
    if between_rad <= MISSED * a.deviation_rad.hypot(b.deviation_rad) {
        return true;
    }
    // The nearest points of two lines, which are not parallel here.
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

/// The least squares intersection of rays, each weighted by its deviation at its distance. `None`
/// for less than two rays, for parallel ones, and if it is behind one of them.
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
            // Relative to the first origin, so that a world far away costs no digits.
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
