//! The published form: equations 2 to 4 of Casas et al. 2019, section 3.2.

use glam::{DMat4, DVec2, DVec3, UVec2};

use super::SeenLight;
use super::highlights::{Highlight, middle_px};
use super::reflection::Reflection;
use super::surface::Surface;

/// Each bright region as a light.
///
/// The lens is rectified by its known pose first, which the paper assumes. The direction to the
/// viewer is the lens's axis, R = (0, 0, 1) there; for a ball, the direction from its centre to the
/// camera, as for the chrome spheres of the earlier work that the paper follows. A light's size is
/// that of its region.
pub(super) fn lights(
    highlights: &[Highlight],
    surface: &Surface<'_>,
    world_from_probe: &DMat4,
) -> Vec<SeenLight> {
    let lights = highlights.iter().filter_map(|highlight| {
        let at_px = mean_px(&highlight.bright)?;
        let middle = reflect(surface, at_px)?;
        let mut angular_radius_rad: f64 = 0.0;
        for pixel in &highlight.bright {
            if let Some(other) = reflect(surface, middle_px(*pixel)) {
                angular_radius_rad = angular_radius_rad.max(other.toward.angle_between(middle.toward));
            }
        }
        let seen = middle.in_world(world_from_probe);
        Some(SeenLight {
            origin_in_world: seen.at,
            direction_in_world: seen.toward,
            // A centre of whole pixels has no known deviation.
            deviation_rad: f64::INFINITY,
            angular_radius_rad,
            power: highlight.weighted.iter().map(|(_, light)| light).sum(),
            at_px,
        })
    });
    let mut lights: Vec<SeenLight> = lights.collect();
    lights.sort_by(|a, b| b.power.total_cmp(&a.power));
    lights
}

/// Equation 3.
fn mean_px(pixels: &[UVec2]) -> Option<DVec2> {
    let n_pixels = pixels.len() as f64;
    let sum: DVec2 = pixels.iter().map(|pixel| middle_px(*pixel)).sum();
    (!pixels.is_empty()).then(|| sum / n_pixels)
}

/// Equation 4, with the hemisphere's normal.
fn reflect(surface: &Surface<'_>, at_px: DVec2) -> Option<Reflection> {
    match surface {
        Surface::Lens(lens) => {
            let at = lens.place(at_px)?;
            let across = at / lens.radius_m;
            let normal = across + (1.0 - across.length_squared()).max(0.0).sqrt() * DVec3::Y;
            Reflection::of(at, normal, DVec3::Y)
        }
        Surface::Ball(ball) => {
            let (normal, viewer) = ball.normal_for_far_viewer(at_px)?;
            Reflection::of(ball.radius_m * normal, normal, viewer)
        }
    }
}
