//! The shaders' view of the published method's settings.

use crate::gpu::layout::{MAX_LIGHTS, MAX_RECEIVERS, Published as PublishedLayout};
use crate::preset::PublishedSettings;
use crate::region::Bounds;
use crate::scene::{Light, Surface};
use crate::view::Place;

/// The settings, and what the shaders must know of lights and receivers besides where they are. `toy` bounds the toy in
/// any pose, in stage space.
pub(crate) fn uniform(place: &Place<'_>, toy: &Bounds, settings: &PublishedSettings) -> PublishedLayout {
    let mut light_radii = [0.0; MAX_LIGHTS];
    for (slot, light) in light_radii.iter_mut().zip(place.lights) {
        *slot = disc_radius(light);
    }
    let mut tallest_m = [0.0; MAX_RECEIVERS];
    let mut textured_receivers = 0;
    let world_from_stage = place.world_from_stage();
    for (index, receiver) in place.receivers.iter().take(MAX_RECEIVERS).enumerate() {
        let plane_from_stage = receiver.world_from_plane.inverse() * world_from_stage;
        tallest_m[index] = narrowed(toy.transformed(&plane_from_stage).max.y);
        textured_receivers |= u32::from(receiver.surface == Surface::Textured) << index;
    }
    let ratio = settings.constant_ratio;
    PublishedLayout {
        light_radii,
        tallest_m,
        textured_receivers,
        is_constant: u32::from(ratio.is_some()),
        constant_ratio: ratio.map_or(0.0, |of_all| ratio_per_light(of_all, place.lights.len())),
        eligible_margin_px: settings.eligible_margin_px,
        ring_step_px: settings.ring_step_px,
        n_ring_directions: settings.n_ring_directions,
        n_rings: settings.n_rings,
        box_radius_px: settings.box_radius_px,
        seam_px: settings.seam_px,
        n_blocker_taps: settings.n_blocker_taps,
        n_filter_taps: settings.n_filter_taps,
        _pad: 0,
    }
}

/// Each light's ratio, such that the product over all lights is `of_all`: shadows of AR products multiply.
fn ratio_per_light(of_all: f32, n_lights: usize) -> f32 {
    #[allow(clippy::cast_precision_loss, reason = "at most MAX_LIGHTS")]
    let n_lights = n_lights.max(1) as f32;
    of_all.powf(n_lights.recip())
}

/// Metres for a sphere, slope for a directional light.
fn disc_radius(light: &Light) -> f32 {
    narrowed(match *light {
        Light::Sphere { radius_m, .. } => radius_m,
        Light::Directional {
            angular_radius_rad, ..
        } => angular_radius_rad.tan(),
    })
}

#[allow(clippy::cast_possible_truncation, reason = "a shader takes no more")]
fn narrowed(value: f64) -> f32 {
    value as f32
}
