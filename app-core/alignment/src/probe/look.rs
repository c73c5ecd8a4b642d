//! Evaluates one picture of a probe.

use glam::{DVec2, DVec3};

use super::error::{self, ProbeError};
use super::highlights;
use super::surface::Surface;
use super::{Form, ProbeView, Sighting, published, reading};
use app_scene::scene::Facet;

/// Estimates the lights from a picture.
///
/// # Errors
/// When a value is invalid, the number of bytes does not fit the picture's size, or the probe is
/// out of the picture, behind the camera, seen from behind or too small.
pub fn look(view: &ProbeView<'_>, form: Form) -> Result<Sighting, ProbeError> {
    error::check(view)?;
    let surface = Surface::new(view);
    let world_from_probe = &view.picture.world_from_probe;
    let seen = highlights::find(&view.picture.image, &surface)?;
    Ok(match form {
        Form::Exact => {
            let mut sighting = Sighting::default();
            for highlight in &seen {
                match reading::light(highlight, &surface, world_from_probe) {
                    Ok(light) => sighting.lights.push(light),
                    Err(rejected) => sighting.rejected.push(rejected),
                }
            }
            sighting.lights.sort_by(|a, b| b.power.total_cmp(&a.power));
            sighting
        }
        Form::Published => Sighting {
            lights: published::lights(&seen, &surface, world_from_probe),
            rejected: Vec::new(),
        },
    })
}

/// The facet that shows a light of known direction at a pixel: one entry of a lens's
/// [`FacetSlope::Table`](app_scene::scene::FacetSlope::Table). One move of a lamp from the axis to
/// the horizon calibrates a lens; sort the entries afterwards.
///
/// `None` if the pixel shows no lens, or the lens's centre, or if no facet of a lens could reflect
/// that light.
///
/// # Errors
/// When a value is invalid.
pub fn facet_at(
    view: &ProbeView<'_>,
    at_px: DVec2,
    direction_to_light_in_world: DVec3,
) -> Result<Option<Facet>, ProbeError> {
    error::check(view)?;
    let probe_from_world = view.picture.world_from_probe.inverse();
    let light = probe_from_world
        .transform_vector3(direction_to_light_in_world)
        .try_normalize();
    Ok(match (Surface::new(view), light) {
        (Surface::Lens(lens), Some(light)) => lens.facet_at(at_px, light),
        _ => None,
    })
}
