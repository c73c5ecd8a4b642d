//! What a scene brings that a preset can use, and warnings that stand for all its frames.

use glam::DMat4;

use crate::frame::Warning;
use crate::light_points::light_in_plane;
use crate::scene::{Light, Scene};

/// The first `most` lights above the first receiver, and what is left out.
pub(crate) fn usable_lights(
    scene: &Scene,
    plane_from_world: &DMat4,
    most: usize,
) -> (Vec<Light>, Vec<Warning>) {
    let mut warnings = Vec::new();
    let mut lights = Vec::new();
    for (index, light) in scene.lights.iter().enumerate() {
        if light_in_plane(light, plane_from_world).y > 0.0 {
            lights.push(*light);
        } else {
            warnings.push(Warning::LightBelowReceiver { light: index });
        }
    }
    if lights.len() > most {
        warnings.push(Warning::LightsLeftOut {
            n_lights: lights.len() - most,
        });
        lights.truncate(most);
    }
    if scene.receivers.len() > 1 {
        let names = scene.receivers[1..]
            .iter()
            .map(|receiver| receiver.name.clone())
            .collect();
        warnings.push(Warning::ReceiversLeftOut { names });
    }
    (lights, warnings)
}
