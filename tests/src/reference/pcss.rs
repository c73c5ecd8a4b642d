//! Twin of `pcss.wgsl`: percentage-closer soft shadows on the receiver.

use std::f64::consts::PI;

use glam::{DVec2, DVec4, UVec2};

use super::model::{Region, centre_px};
use super::raster::Raster;

/// The light and the open constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softness {
    /// The light's centre, homogeneous, in plane space.
    pub light: DVec4,
    /// Radius of the light's disc: metres for a sphere, slope for a directional light.
    pub light_radius: f64,
    /// Bounds the height of the toy.
    pub tallest_m: f64,
    /// Taps of the blocker search.
    pub n_blocker_taps: u32,
    /// Taps of the filter.
    pub n_filter_taps: u32,
}

impl Softness {
    /// Radius on the receiver of the shadow that a point at `height_m` casts of the light's disc; 0 from the light's
    /// height on.
    #[must_use]
    pub fn penumbra_radius_m(&self, height_m: f64) -> f64 {
        let above_m = if self.light.w == 0.0 {
            self.light.y
        } else {
            self.light.y - height_m
        };
        if above_m > 0.0 {
            self.light_radius * height_m / above_m
        } else {
            0.0
        }
    }
}

/// Visibility at a texel of the region. `heights_m` has the height of the occluder whose shadow, seen from the light's
/// centre, falls on a texel; none where there is none.
#[must_use]
pub fn soft_visibility(
    heights_m: &Raster<Option<f64>>,
    region: &Region,
    softness: &Softness,
    texel: UVec2,
) -> f64 {
    let at = centre_px(texel);
    let Some(in_plane) = region
        .receiver_point(at)
        .filter(|point| point.receiver == 0)
        .map(|point| point.in_plane)
    else {
        return 1.0;
    };
    let half_pixel_m = region.receivers[0]
        .plane_point(at + DVec2::X)
        .map_or(0.0, |next| 0.5 * next.distance(in_plane));
    let blockers = |radius_m: f64, n_taps| -> Vec<f64> {
        let taps = (0..n_taps).map(|k| in_plane + radius_m * vogel(k, n_taps));
        taps.filter_map(|tap| height_near(heights_m, region, tap))
            .collect()
    };
    let reach_m = softness.penumbra_radius_m(softness.tallest_m).max(half_pixel_m);
    let found = blockers(reach_m, softness.n_blocker_taps);
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
    let blocked = blockers(radius_m, softness.n_filter_taps);
    1.0 - count(&blocked) / f64::from(softness.n_filter_taps)
}

fn height_near(heights_m: &Raster<Option<f64>>, region: &Region, in_plane: DVec2) -> Option<f64> {
    let at = region.receivers[0].plane_from_region_px.inverse() * in_plane.extend(1.0);
    let px = at.truncate() / at.z;
    let is_inside = at.z > 0.0 && px.cmpge(DVec2::ZERO).all() && px.cmplt(heights_m.size().as_dvec2()).all();
    is_inside.then(|| heights_m.at(px.as_uvec2())).flatten()
}

/// Point k of n over the unit disc. Source: Vogel 1979.
fn vogel(k: u32, n: u32) -> DVec2 {
    let golden_angle_rad = PI * (3.0 - 5f64.sqrt());
    ((f64::from(k) + 0.5) / f64::from(n)).sqrt() * DVec2::from_angle(f64::from(k) * golden_angle_rad)
}

#[allow(clippy::cast_precision_loss, reason = "a handful of taps")]
fn count(blockers: &[f64]) -> f64 {
    blockers.len() as f64
}
