//! CPU reference of `visibility.wgsl`, and the same without its approximations: how much of a light a receiver point sees.

use glam::{DVec2, DVec3, UVec2};

use app_core::scene::Light;

use super::model::Region;
use super::occlusion::{Caster, Occluder, hidden_share};
use super::raster::Raster;

/// Visibility over a map of `map_px` texels of the region, from what a caster for each receiver leaves of a light.
///
/// A texel that looks past the receivers is wholly visible.
#[must_use]
pub fn visibility_map(casters: &[Caster], region: &Region, map_px: UVec2) -> Raster<f64> {
    let hidden = |texel| hidden_share(casters, region, (map_px, texel));
    Raster::from_fn(map_px, |texel| 1.0 - hidden(texel).unwrap_or(0.0))
}

/// Share of a light's irradiance that reaches the receiver point (x, z), from `n_rays` rays over its outline.
///
/// `light` is in plane space, and shines evenly in all directions. Rays are even in solid angle and weigh by their
/// cosine. A light around the point, or one under the receiver, is wholly visible.
/// Source: Shirley, Wang and Zimmerman 1996, section 3.2 (sampling the cone that a sphere fills).
#[must_use]
pub fn exact_visibility(occluder: &Occluder, in_plane: DVec2, light: &Light, n_rays: usize) -> f64 {
    let origin = DVec3::new(in_plane.x, 0.0, in_plane.y);
    let (axis, distance_m, sine) = match *light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => {
            let to_centre = position_in_world - origin;
            let distance_m = to_centre.length();
            (to_centre / distance_m, distance_m, radius_m / distance_m)
        }
        Light::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        } => (
            direction_to_light_in_world,
            f64::INFINITY,
            angular_radius_rad.sin(),
        ),
    };
    if sine >= 1.0 {
        return 1.0;
    }
    let (across, along) = axis.any_orthonormal_pair();
    let (mut reached, mut total) = (0.0, 0.0);
    for at in unit_disc(n_rays) {
        // Equal areas of the disc are equal solid angles of the cone.
        let cosine = 1.0 - at.length_squared() * sine * sine / (1.0 + (1.0 - sine * sine).sqrt());
        let side = (1.0 - cosine * cosine).max(0.0).sqrt() * at.normalize_or_zero();
        let direction = cosine * axis + side.x * across + side.y * along;
        let weight = direction.y.max(0.0);
        let light_point = if distance_m.is_finite() {
            let to_surface_m = distance_m * (cosine - (sine * sine - side.length_squared()).max(0.0).sqrt());
            (origin + to_surface_m * direction).extend(1.0)
        } else {
            direction.extend(0.0)
        };
        total += weight;
        if weight > 0.0 && !occluder.hides(in_plane, light_point) {
            reached += weight;
        }
    }
    if total > 0.0 { reached / total } else { 1.0 }
}

/// `n_points` points over the unit disc, each standing for an equal area. Source: Vogel 1979.
fn unit_disc(n_points: usize) -> impl Iterator<Item = DVec2> {
    let golden_angle_rad = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    #[allow(clippy::cast_precision_loss, reason = "far fewer than 2^52 points")]
    (0..n_points).map(move |i| {
        ((i as f64 + 0.5) / n_points as f64).sqrt() * DVec2::from_angle(i as f64 * golden_angle_rad)
    })
}
