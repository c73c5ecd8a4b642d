//! Bounding boxes and bounding spheres of points.

use glam::{DMat4, DVec3, DVec4, Vec3, Vec4Swizzles};

/// A box, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The eight corners.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..8).map(|k| {
            DVec3::new(
                if k & 1 == 0 { self.min.x } else { self.max.x },
                if k & 2 == 0 { self.min.y } else { self.max.y },
                if k & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The centre of the box.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// The box around points; inverted if there is none.
    #[must_use]
    pub fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let nothing = Self {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        };
        points.fold(nothing, |bounds, p| Self {
            min: bounds.min.min(p),
            max: bounds.max.max(p),
        })
    }

    /// The box around this one in another space.
    #[must_use]
    pub fn transformed(&self, there_from_here: &DMat4) -> Self {
        Self::around(self.corners().map(|p| there_from_here.transform_point3(p)))
    }
}

/// A bounding sphere of a posed toy, in anchor space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub centre: DVec3,
    /// In metres.
    pub radius_m: f64,
}

impl Sphere {
    /// The sphere around the centre of the points' bounding box; of radius 0 without points.
    #[must_use]
    pub fn around(points: &[Vec3]) -> Self {
        let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let centre = 0.5 * (low.as_dvec3() + high.as_dvec3());
        let distances = points.iter().map(|point| point.as_dvec3().distance(centre));
        Self {
            centre,
            radius_m: distances.fold(0.0, f64::max),
        }
    }

    /// Whether a homogeneous light point is inside; a direction never is.
    #[must_use]
    pub fn holds(&self, light_point: DVec4) -> bool {
        light_point.w != 0.0 && light_point.xyz().distance(self.centre) <= self.radius_m
    }
}
