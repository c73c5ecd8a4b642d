//! CPU reference of the priors of `fit_solve.wgsl` for the light on a receiver.

use std::iter;

use glam::DVec3;

use super::model::{ReceiverPlane, Region, Solution};

/// Prior of the bounce, as a fraction of the ambient light that the toy blocks: that of a toy of
/// middle grey.
pub const PRIOR_BOUNCE: f64 = 0.27;
/// Prior of the direct share of the plate's radiance, over all lights.
pub const PRIOR_DIRECT_FRACTION: f64 = 0.5;
/// Largest bounce, as a fraction of the ambient light that the toy blocks; also its prior if no
/// light is known.
pub const MAX_BOUNCE: f64 = 1.0;

/// Priors of bounce and shares without a visible shadow on the receiver.
#[must_use]
pub fn receiver_priors(region: &Region, receiver: usize, before: &Solution, channel: usize) -> Vec<f64> {
    let n_lights = region.lights.len();
    let irradiance = |plane: &ReceiverPlane, i: usize| {
        let light = plane.lights[i];
        let at = DVec3::new(plane.reference_in_plane.x, 0.0, plane.reference_in_plane.y);
        let to_light = light.truncate() - at * light.w;
        let falloff = if light.w == 0.0 {
            1.0
        } else {
            to_light.length_squared()
        };
        (to_light.normalize().y / falloff).max(0.0)
    };
    if receiver == 0 {
        // All lights count as if they had the same intensity at one metre.
        let each: Vec<f64> = (0..n_lights)
            .map(|i| irradiance(&region.receivers[0], i))
            .collect();
        let total: f64 = each.iter().sum();
        let share = |one: f64| if total > 0.0 { one / total } else { 0.0 };
        let direct_fractions = each.iter().map(|one| PRIOR_DIRECT_FRACTION * share(*one));
        let bounce = if n_lights == 0 { MAX_BOUNCE } else { PRIOR_BOUNCE };
        return iter::once(bounce).chain(direct_fractions).collect();
    }
    // The same lights with the same ambient light.
    let first = &before.receivers[0];
    let of_first = |i| {
        let there = irradiance(&region.receivers[0], i);
        if there > 0.0 {
            irradiance(&region.receivers[receiver], i) / there
        } else {
            0.0
        }
    };
    let of_channel = |i: usize| first.direct_fractions[i][channel];
    let direct_fractions: Vec<f64> = (0..n_lights).map(|i| of_channel(i) * of_first(i)).collect();
    let direct: f64 = (0..n_lights).map(of_channel).sum();
    let total = 1.0 - direct + direct_fractions.iter().sum::<f64>();
    // Nothing is known of a light behind the first one: here it counts as one of as many equal ones.
    let is_behind_first = |i: usize| irradiance(&region.receivers[0], i) == 0.0;
    let is_here = |i: usize| irradiance(&region.receivers[receiver], i) > 0.0;
    let direct_fractions = direct_fractions.iter().enumerate().map(|(i, fraction)| {
        if is_behind_first(i) && is_here(i) {
            PRIOR_DIRECT_FRACTION / n_lights as f64
        } else {
            fraction / total
        }
    });
    iter::once(first.bounce[channel])
        .chain(direct_fractions)
        .collect()
}
