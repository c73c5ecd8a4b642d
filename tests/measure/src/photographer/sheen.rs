//! Specular reflection of a toy's surface: of lamps by their centres, of everything else by rays.

use std::f64::consts::PI;

use glam::DVec3;

use super::lamp::Lamp;
use super::rays::{Hit, Place};
use super::world::Sheen;

/// Reflectance of plastic at normal incidence.
const STRAIGHT: f64 = 0.04;

impl Sheen {
    /// Radiance of a lamp's reflection towards `to_camera`, relative to a white matt surface.
    pub(super) fn of_lamp(&self, hit: &Hit, to_camera: DVec3, lamp: &Lamp) -> f64 {
        let to_lamp = lamp.cone(hit.at).axis;
        let half_way = (to_camera + to_lamp).normalize();
        let [v, l, h] = [to_camera, to_lamp, half_way].map(|direction| hit.normal.dot(direction));
        if v <= 0.0 || l <= 0.0 {
            return 0.0;
        }
        let squared = self.roughness * self.roughness;
        let slope_squared = 1.0 / (h * h) - 1.0;
        let distribution = (-slope_squared / squared).exp() / (PI * squared * h.powi(4));
        let brdf = distribution * fresnel(to_lamp.dot(half_way)) * self.unmasked(v) * self.unmasked(l)
            / (4.0 * v * l);
        self.strength * PI * brdf
    }

    /// Radiance of the reflected surroundings and sky, with the facets' slopes in a pattern over
    /// the unit disc.
    pub(super) fn of_place(
        &self,
        (place, hit): (&Place<'_>, &Hit),
        to_camera: DVec3,
        pattern: usize,
    ) -> DVec3 {
        let (across, along) = hit.normal.any_orthonormal_pair();
        let pattern = place.sky_pattern(pattern);
        let light = pattern.iter().map(|at| {
            let slope = self.roughness * (-(1.0 - at.length_squared()).max(f64::MIN_POSITIVE).ln()).sqrt();
            let side = at.normalize_or_zero() * slope;
            let facet = (hit.normal + side.x * across + side.y * along).normalize();
            let direction = 2.0 * facet.dot(to_camera) * facet - to_camera;
            let [v, l, h] = [to_camera, direction, facet].map(|direction| hit.normal.dot(direction));
            if l <= 0.0 || v <= 0.0 {
                return DVec3::ZERO;
            }
            // Facets are sampled by their area as seen along the normal. Source: Walter et al.
            // 2007, (41).
            let weight = facet.dot(to_camera) * self.unmasked(v) * self.unmasked(l) / (v * h);
            weight * fresnel(facet.dot(to_camera)) * place.light_along(hit, direction)
        });
        let n_rays = pattern.len() as f64;
        self.strength * light.sum::<DVec3>() / n_rays
    }

    /// Share of the facets that are visible along a direction, for its cosine to the normal.
    /// Source: Walter et al. 2007, table 1.
    fn unmasked(&self, cosine: f64) -> f64 {
        let a = cosine / (self.roughness * (1.0 - cosine * cosine).max(f64::MIN_POSITIVE).sqrt());
        if a >= 1.6 {
            return 1.0;
        }
        (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
    }
}

/// Fresnel reflectance. Source: Schlick 1994.
fn fresnel(cosine: f64) -> f64 {
    STRAIGHT + (1.0 - STRAIGHT) * (1.0 - cosine.clamp(0.0, 1.0)).powi(5)
}
