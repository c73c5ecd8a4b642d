//! What a scene brings that a preset can use, and warnings that stand for all its frames.

use glam::{DMat4, DVec3};

use crate::frame::warning::Warning;
use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::light_points::light_in_plane;
use crate::scene::{Light, MAX_LIGHTS, MAX_RECEIVERS, Scene};

/// What is used of a scene.
pub(crate) struct Usable {
    pub(crate) lights: Vec<Light>,
    /// Their places in the scene's list.
    pub(crate) light_indices: Vec<usize>,
    pub(crate) receivers: Vec<AnchoredReceiver>,
    /// What is left out.
    pub(crate) warnings: Vec<Warning>,
}

/// The first receivers, anchored near the toy, and the first lights that stand above one of them.
pub(crate) fn usable(scene: &Scene, toy_in_world: DVec3) -> Usable {
    let mut warnings = Vec::new();
    let (used, left_out) = scene.receivers.split_at(MAX_RECEIVERS.min(scene.receivers.len()));
    if !left_out.is_empty() {
        warnings.push(Warning::ReceiversLeftOut {
            names: left_out.iter().map(|receiver| receiver.name.clone()).collect(),
        });
    }
    let planes_from_world: Vec<DMat4> = used
        .iter()
        .map(|receiver| receiver.world_from_plane.inverse())
        .collect();
    let (mut lights, mut light_indices) = (Vec::new(), Vec::new());
    for (index, light) in scene.lights.iter().enumerate() {
        let is_above = |plane_from_world: &DMat4| light_in_plane(light, plane_from_world).y > 0.0;
        if planes_from_world.iter().any(is_above) {
            lights.push(*light);
            light_indices.push(index);
        } else {
            warnings.push(Warning::LightBelowReceiver { light: index });
        }
    }
    if lights.len() > MAX_LIGHTS {
        warnings.push(Warning::LightsLeftOut {
            n_lights: lights.len() - MAX_LIGHTS,
        });
        lights.truncate(MAX_LIGHTS);
    }
    Usable {
        lights,
        light_indices,
        receivers: used
            .iter()
            .map(|receiver| AnchoredReceiver::near(receiver, toy_in_world))
            .collect(),
        warnings,
    }
}
