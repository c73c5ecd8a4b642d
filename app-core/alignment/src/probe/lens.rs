//! A flat Fresnel lens as a mirror.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::reflection::Reflection;
use super::viewpoint::Viewpoint;
use app_scene::scene::{Facet, FacetSlope};

/// Distance from the axis, over the radius, below which a facet has no direction to lean to.
const MIDDLE: f64 = 1e-3;

/// A lens in its own space: a disc in y = 0 with its front along +Y.
#[derive(Clone, Debug)]
pub(super) struct Lens<'a> {
    pub(super) viewpoint: Viewpoint,
    pub(super) radius_m: f64,
    pub(super) slope: &'a FacetSlope,
}

impl Lens<'_> {
    /// The point of the disc at a pixel, and the direction from there to the viewer.
    fn point(&self, at_px: DVec2) -> Option<(DVec3, DVec3)> {
        let (from, along) = (self.viewpoint.place(), self.viewpoint.sight(at_px));
        if from.y <= 0.0 || along.y >= 0.0 {
            return None;
        }
        let at = from - along * (from.y / along.y);
        let at = DVec3::new(at.x, 0.0, at.z);
        (at.length() <= self.radius_m).then_some((at, -along))
    }

    /// The point of the disc at a pixel.
    pub(super) fn place(&self, at_px: DVec2) -> Option<DVec3> {
        self.point(at_px).map(|(at, _)| at)
    }

    /// The reflection of a pixel's line of sight: L = 2 (N · V) N − V, with the facet's normal N
    /// and V to the viewer.
    pub(super) fn reflect(&self, at_px: DVec2) -> Option<Reflection> {
        let (at, viewer) = self.point(at_px)?;
        let slope_rad = self.slope.at(at.length() / self.radius_m, self.radius_m);
        let (lean, up) = slope_rad.sin_cos();
        let normal = lean * at.normalize_or_zero() + up * DVec3::Y;
        Reflection::of(at, normal.normalize(), viewer)
    }

    /// The facet that reflects light from the given direction at a pixel: N bisects the angle
    /// between L and V.
    pub(super) fn facet_at(&self, at_px: DVec2, light: DVec3) -> Option<Facet> {
        let (at, viewer) = self.point(at_px)?;
        let normal = (light + viewer).try_normalize()?;
        let of_radius = at.length() / self.radius_m;
        if of_radius < MIDDLE {
            return None;
        }
        let slope_rad = normal.dot(at.normalize()).atan2(normal.y);
        (0.0..FRAC_PI_2).contains(&slope_rad).then_some(Facet {
            at: of_radius,
            slope_rad,
        })
    }
}
