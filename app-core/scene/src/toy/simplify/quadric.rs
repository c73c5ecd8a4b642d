//! Squared distances from planes, as a sum over all of them.

use glam::{DMat3, DVec3};

/// A weighted sum of squared distances from planes: a quadratic form of the point. Source: Garland and Heckbert 1997, section 5.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadric {
    squares: DMat3,
    linear: DVec3,
    constant: f64,
    weight: f64,
}

impl Quadric {
    /// A quadric of no plane.
    pub(super) const NONE: Self = Self {
        squares: DMat3::ZERO,
        linear: DVec3::ZERO,
        constant: 0.0,
        weight: 0.0,
    };

    /// The quadric of a plane through a point, with a normal of unit length.
    pub(super) fn of_plane(normal: DVec3, through: DVec3, weight: f64) -> Self {
        let distance = -normal.dot(through);
        let scaled = weight * normal;
        Self {
            squares: DMat3::from_cols(scaled * normal.x, scaled * normal.y, scaled * normal.z),
            linear: distance * scaled,
            constant: weight * distance * distance,
            weight,
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.linear += other.linear;
        self.constant += other.constant;
        self.weight += other.weight;
    }

    /// Root of the mean squared distance; 0 without planes.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        if self.weight == 0.0 {
            return 0.0;
        }
        let sum = point.dot(self.squares * point) + 2.0 * self.linear.dot(point) + self.constant;
        // Rounding may make a sum of squares negative.
        (sum.max(0.0) / self.weight).sqrt()
    }
}
