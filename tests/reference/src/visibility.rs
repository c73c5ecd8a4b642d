//! CPU reference of the maps of `occlusion.wgsl`, and the same without its approximations:
//! visibility of a light from a receiver point.

use app_core::scene::Light;
use app_scene::geometry::disc::vogel_disc;
use glam::{DVec2, DVec3, UVec2};

use super::model::Region;
use super::occlusion::{
    Caster, Occluder, PointSpread, hidden_share, hidden_share_from, sample_position, spread_position,
    taken_from,
};
use super::raster::Raster;
use super::real::{Real, Vector};

/// Visibility over a map of `map_px` texels of the region, with a caster for each receiver.
///
/// A texel without receiver is fully visible.
#[must_use]
pub fn visibility_map<R: Real>(casters: &[Caster<R>], region: &Region, map_px: UVec2) -> Raster<f64> {
    let hidden = |texel| hidden_share(casters, region, (map_px, texel));
    Raster::from_fn(map_px, |texel| 1.0 - hidden(texel).unwrap_or(0.0))
}

/// Visibility of the ambient light over a map: what the mesh leaves, less on upright receivers what
/// its shadows on others take. `shadows` has the visibilities of the lights over the region.
#[must_use]
pub fn ambient_map<R: Real>(
    casters: &[Caster<R>],
    region: &Region,
    map_px: UVec2,
    shadows: &[Raster<f64>],
) -> Raster<f64> {
    let open = visibility_map(casters, region, map_px);
    let region_px_per_texel = region.size_px.as_dvec2() / map_px.as_dvec2();
    Raster::from_fn(map_px, |texel| {
        let centre = (texel.as_dvec2() + 0.5) * region_px_per_texel;
        let Some(from) = region.receiver_point(centre).filter(|_| casters.len() > 1) else {
            return open.at(texel);
        };
        let directions = &casters[from.receiver].light_points;
        let hidden = |i: usize, _, at_px: DVec2| 1.0 - shadows[i].at(at_px.as_uvec2());
        let taken = directions
            .iter()
            .map(|direction| taken_from(region, from, direction.truncate(), hidden));
        open.at(texel) * (1.0 - taken.sum::<f64>() / directions.len() as f64).max(0.0)
    })
}

/// Visibility as by [`visibility_map`] for a blurred picture, given the spread of a point.
#[must_use]
pub fn soft_visibility_map<R: Real>(
    casters: &[Caster<R>],
    region: &Region,
    map_px: UVec2,
    spread: PointSpread,
) -> Raster<f64> {
    let place = |i, n_points| spread_position(sample_position(i, n_points), spread);
    let hidden = |texel| hidden_share_from(casters, region, (map_px, texel), place);
    Raster::from_fn(map_px, |texel| 1.0 - hidden(texel).unwrap_or(0.0))
}

/// Share of a light's irradiance that reaches the receiver point (x, z), from `n_rays` rays over
/// its outline.
///
/// `light` is in plane space, and radiates uniformly. Rays are uniform in solid angle and weighted
/// by their cosine. A light around the point, or one under the receiver, is fully visible. Source:
/// Shirley, Wang and Zimmerman 1996, section 3.2 (sampling the cone of a sphere).
#[must_use]
pub fn exact_visibility<R: Real>(
    occluder: &Occluder<R>,
    in_plane: DVec2,
    light: &Light,
    n_rays: usize,
) -> f64 {
    let origin = Vector::from(DVec3::new(in_plane.x, 0.0, in_plane.y));
    let (axis, distance_m, sine) = match *light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => {
            let to_centre = Vector::from(position_in_world) - origin;
            let distance_m = to_centre.length();
            (
                to_centre / distance_m,
                distance_m,
                R::from_f64(radius_m) / distance_m,
            )
        }
        Light::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        } => (
            Vector::from(direction_to_light_in_world),
            R::from_f64(f64::INFINITY),
            R::from_f64(angular_radius_rad.sin()),
        ),
    };
    if sine >= R::ONE {
        return 1.0;
    }
    let (across, along) = axis.orthonormal_pair();
    let (mut reached, mut total) = (R::ZERO, R::ZERO);
    for at in vogel_disc(n_rays) {
        // Equal areas of the disc are equal solid angles of the cone.
        let area = R::from_f64(at.length_squared());
        let cosine = R::ONE - area * sine * sine / (R::ONE + (R::ONE - sine * sine).sqrt());
        let sideways = (R::ONE - cosine * cosine).max(R::ZERO).sqrt();
        let side = Vector::from(at.normalize_or_zero().extend(0.0)) * sideways;
        let direction = axis * cosine + across * side[0] + along * side[1];
        let weight = direction[1].max(R::ZERO);
        let light_point = if distance_m.to_f64().is_finite() {
            let inwards = (sine * sine - side.dot(side)).max(R::ZERO).sqrt();
            let to_surface_m = distance_m * (cosine - inwards);
            DVec3::from(origin + direction * to_surface_m).extend(1.0)
        } else {
            DVec3::from(direction).extend(0.0)
        };
        total += weight;
        if weight > R::ZERO && !occluder.hides(in_plane, light_point) {
            reached += weight;
        }
    }
    if total > R::ZERO {
        (reached / total).to_f64()
    } else {
        1.0
    }
}
