//! Lights, and the directions of a light as seen from a point.

use app_core::scene::Light;
use glam::{DVec2, DVec3};

/// A light with its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// The light as a scene lists it.
    pub light: Light,
    /// Radiance of a white surface that faces it, linear: at a distance of 1 m from a sphere's
    /// centre, anywhere under a directional light.
    pub color: DVec3,
}

/// The cone of directions to a light from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    /// Unit vector to its centre.
    pub(super) axis: DVec3,
    /// Sine of half its angle.
    pub(super) sine: f64,
    /// Distance of the light's centre; infinite for a directional one.
    pub(super) distance_m: f64,
    /// Share of the lamp's colour on a white surface that faces it here.
    pub(super) strength: f64,
}

impl Lamp {
    /// A white bulb.
    #[must_use]
    pub fn bulb(position_in_world: DVec3, radius_m: f64, brightness: f64) -> Self {
        Self {
            light: Light::sphere(position_in_world, radius_m),
            color: DVec3::splat(brightness),
        }
    }

    /// A white directional light.
    #[must_use]
    pub fn sun(direction_to_light_in_world: DVec3, angular_radius_rad: f64, brightness: f64) -> Self {
        Self {
            light: Light::directional(direction_to_light_in_world, angular_radius_rad),
            color: DVec3::splat(brightness),
        }
    }

    pub(super) fn cone(&self, at: DVec3) -> Cone {
        match self.light {
            Light::Sphere {
                position_in_world,
                radius_m,
            } => {
                let to_centre = position_in_world - at;
                // For a point on the surface or in the bulb it fills half of the view.
                let distance_m = to_centre.length().max(radius_m).max(f64::MIN_POSITIVE);
                Cone {
                    axis: to_centre.normalize_or(DVec3::Y),
                    sine: radius_m / distance_m,
                    distance_m,
                    strength: 1.0 / (distance_m * distance_m),
                }
            }
            Light::Directional {
                direction_to_light_in_world,
                angular_radius_rad,
            } => Cone {
                axis: direction_to_light_in_world,
                sine: angular_radius_rad.sin(),
                distance_m: f64::INFINITY,
                strength: 1.0,
            },
        }
    }

    /// Radiance of its disc: a white surface that faces it has that times the squared sine of its
    /// half angle.
    pub(super) fn radiance(&self) -> DVec3 {
        let sine_at_1_m = match self.light {
            Light::Sphere { radius_m, .. } => radius_m,
            Light::Directional {
                angular_radius_rad, ..
            } => angular_radius_rad.sin(),
        };
        self.color * sine_at_1_m.powi(-2)
    }
}

impl Cone {
    /// Cosine of half its angle.
    fn cosine(&self) -> f64 {
        (1.0 - self.sine * self.sine).max(0.0).sqrt()
    }

    /// Directions into the cone, each for an equal solid angle, along a pattern over the unit disc.
    pub(super) fn directions(self, pattern: &[DVec2]) -> impl Iterator<Item = DVec3> {
        let (across, along) = self.axis.any_orthonormal_pair();
        let squared_sine = self.sine * self.sine;
        let flatness = squared_sine / (1.0 + self.cosine());
        pattern.iter().map(move |at| {
            // Equal areas of the disc are equal solid angles. Source: Shirley, Wang and Zimmerman 1996, 3.2.
            let area = at.length_squared();
            let cosine = 1.0 - area * flatness;
            let sideways = (1.0 - cosine * cosine).max(0.0).sqrt();
            let side = at.normalize_or_zero() * sideways;
            self.axis * cosine + across * side.x + along * side.y
        })
    }

    /// Weight of a direction's cosine: the light's radiance times the solid angle per direction, so
    /// that a small light overhead gives its strength.
    pub(super) fn weight(&self) -> f64 {
        self.strength * 2.0 / (1.0 + self.cosine())
    }

    /// Whether no direction of the cone meets a ball.
    pub(super) fn misses(&self, to_ball: DVec3, radius_m: f64) -> bool {
        let distance_m = to_ball.length();
        if distance_m <= radius_m {
            return false;
        }
        let between_rad = (self.axis.dot(to_ball) / distance_m).clamp(-1.0, 1.0).acos();
        between_rad > self.sine.min(1.0).asin() + (radius_m / distance_m).asin()
    }
}

/// `n` points over the unit disc, each for an equal area, turned by a fraction of the circle.
/// Source: Vogel 1979.
pub(super) fn disc(n: u32, turn: f64) -> Vec<DVec2> {
    let golden_angle_rad = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let point = |i: u32| {
        let radius = ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
        radius * DVec2::from_angle(f64::from(i) * golden_angle_rad + turn * std::f64::consts::TAU)
    };
    // A single point is the centre.
    if n == 1 {
        vec![DVec2::ZERO]
    } else {
        (0..n).map(point).collect()
    }
}
