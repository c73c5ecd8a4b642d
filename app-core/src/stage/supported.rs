//! Selects the receivers and lights that a preset can use; the others become warnings that stand for all frames.

use glam::{DMat4, DVec3};

use crate::frame::warning::Warning;
use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::light_points::light_in_plane;
use crate::scene::{Light, MAX_LIGHTS, MAX_RECEIVERS, Receiver};

/// Supported receivers.
pub(crate) struct Receivers {
    /// The first [`MAX_RECEIVERS`], anchored near the toy.
    pub(crate) anchored: Vec<AnchoredReceiver>,
    /// About those that are left out.
    pub(crate) warning: Option<Warning>,
}

impl Receivers {
    pub(crate) fn new(receivers: &[Receiver], toy_in_world: DVec3) -> Self {
        let (used, left_out) = receivers.split_at(MAX_RECEIVERS.min(receivers.len()));
        Self {
            anchored: used
                .iter()
                .map(|receiver| AnchoredReceiver::near(receiver, toy_in_world))
                .collect(),
            warning: (!left_out.is_empty()).then(|| Warning::ReceiversLeftOut {
                names: left_out.iter().map(|receiver| receiver.name.clone()).collect(),
            }),
        }
    }
}

/// Supported lights.
pub(crate) struct Lights {
    /// The list that they are taken from: the scene's, or a frame's own.
    pub(crate) listed: Vec<Light>,
    /// The first [`MAX_LIGHTS`] that stand above any receiver.
    pub(crate) used: Vec<Light>,
    /// Indices of `used` in `listed`.
    pub(crate) indices: Vec<usize>,
    /// About those that are left out.
    pub(crate) warnings: Vec<Warning>,
}

impl Lights {
    pub(crate) fn new(listed: &[Light], receivers: &[AnchoredReceiver]) -> Self {
        let planes_from_world: Vec<DMat4> = receivers
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse())
            .collect();
        let is_above_any = |light: &Light| {
            planes_from_world
                .iter()
                .any(|plane_from_world| light_in_plane(light, plane_from_world).y > 0.0)
        };
        let (mut indices, below): (Vec<usize>, Vec<usize>) =
            (0..listed.len()).partition(|index| is_above_any(&listed[*index]));
        let below = below
            .into_iter()
            .map(|light| Warning::LightBelowReceiver { light });
        let mut warnings: Vec<Warning> = below.collect();
        if indices.len() > MAX_LIGHTS {
            warnings.push(Warning::LightsLeftOut {
                n_lights: indices.len() - MAX_LIGHTS,
            });
            indices.truncate(MAX_LIGHTS);
        }
        Self {
            listed: listed.to_vec(),
            used: indices.iter().map(|index| listed[*index]).collect(),
            indices,
            warnings,
        }
    }
}
