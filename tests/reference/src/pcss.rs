//! CPU reference of `pcss.wgsl`: percentage-closer soft shadows on the receiver.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, DVec4, UVec2, Vec3Swizzles};

use super::model::{ReceiverPlane, Region, centre_px};
use super::raster::Raster;

/// The light and the method's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softness {
    /// The light's centre, homogeneous, in plane space.
    pub light: DVec4,
    /// Radius of the light's disc: metres for a sphere, slope for a directional light.
    pub light_radius: f64,
    /// Upper bound of the toy's height.
    pub tallest_m: f64,
    /// Number of taps of the blocker search.
    pub n_blocker_taps: u32,
    /// Number of taps of the filter.
    pub n_filter_taps: u32,
}

impl Softness {
    /// A point of a disc around the ray from `in_plane` to the light, perpendicular to it,
    /// projected along the ray to the receiver.
    #[must_use]
    pub fn slanted(&self, disc: DVec2, in_plane: DVec2) -> DVec2 {
        let to_light = self.light.truncate() - self.light.w * DVec3::new(in_plane.x, 0.0, in_plane.y);
        let (along, away_m) = to_light.xz().normalize_and_length();
        if away_m == 0.0 {
            return disc;
        }
        let sine = to_light.y / to_light.length();
        let on_axis = disc.dot(along);
        disc + (on_axis / sine - on_axis) * along
    }

    /// Radius on the receiver of the shadow that a point at `height_m` casts of the light's disc:
    /// at most that height, the value for a disc that fills more than 45 degrees around the
    /// vertical, or that is no higher than the point.
    #[must_use]
    pub fn penumbra_radius_m(&self, height_m: f64) -> f64 {
        let above_m = if self.light.w == 0.0 {
            self.light.y
        } else {
            self.light.y - height_m
        };
        if self.light_radius == 0.0 {
            0.0
        } else if above_m > self.light_radius {
            self.light_radius * height_m / above_m
        } else {
            height_m
        }
    }
}

/// Visibility at a texel of the region. `heights_m` has the height of the occluder whose shadow,
/// seen from the light's centre, falls on a texel; `None` without one. `of_receivers` has the light
/// for each receiver.
#[must_use]
pub fn soft_visibility(
    heights_m: &Raster<Option<f64>>,
    region: &Region,
    of_receivers: &[Softness],
    texel: UVec2,
) -> f64 {
    let at = centre_px(texel);
    let Some(point) = region.receiver_point(at) else {
        return 1.0;
    };
    let (plane, softness) = (region.plane_of(point), &of_receivers[point.receiver]);
    if softness.light.y <= 0.0 {
        return 1.0;
    }
    let in_plane = point.in_plane;
    let half_pixel_m = plane
        .plane_point(at + DVec2::X)
        .map_or(0.0, |next| 0.5 * next.distance(in_plane));
    let blockers = |offsets: &mut dyn Iterator<Item = DVec2>| -> Vec<f64> {
        offsets
            .filter_map(|offset| height_near(heights_m, plane, in_plane + offset))
            .collect()
    };
    let disc = |radius_m: f64, n_taps| (0..n_taps).map(move |k| radius_m * vogel(k, n_taps));
    let reach_m = softness.penumbra_radius_m(softness.tallest_m).max(half_pixel_m);
    let found = blockers(&mut disc(reach_m, softness.n_blocker_taps));
    let here = heights_m.at(texel);
    if found.is_empty() {
        return if here.is_some() { 0.0 } else { 1.0 };
    }
    let n_found = count(&found);
    if n_found == f64::from(softness.n_blocker_taps) && here.is_some() {
        return 0.0;
    }
    let mean_m = found.iter().sum::<f64>() / n_found;
    let radius_m = softness.penumbra_radius_m(mean_m).max(half_pixel_m);
    let kernel = disc(radius_m, softness.n_filter_taps);
    let blocked = blockers(&mut kernel.map(|offset| softness.slanted(offset, in_plane)));
    1.0 - count(&blocked) / f64::from(softness.n_filter_taps)
}

/// The height at the image of a point of the plane, whichever receiver that pixel shows.
fn height_near(heights_m: &Raster<Option<f64>>, plane: &ReceiverPlane, in_plane: DVec2) -> Option<f64> {
    let px = plane.region_px(in_plane)?;
    let is_inside = px.cmpge(DVec2::ZERO).all() && px.cmplt(heights_m.size().as_dvec2()).all();
    is_inside.then(|| heights_m.at(px.as_uvec2())).flatten()
}

/// Point k of n over the unit disc. Source: Vogel 1979.
fn vogel(k: u32, n: u32) -> DVec2 {
    let golden_angle_rad = PI * (3.0 - 5f64.sqrt());
    ((f64::from(k) + 0.5) / f64::from(n)).sqrt() * DVec2::from_angle(f64::from(k) * golden_angle_rad)
}

fn count(blockers: &[f64]) -> f64 {
    blockers.len() as f64
}
