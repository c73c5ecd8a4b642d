//! Selection of the receivers and lights that a preset can use; the others become warnings that
//! apply to all frames.

use glam::{DMat4, DVec3};

use crate::frame::warning::Warning;
use crate::geometry::anchored::AnchoredReceiver;
use app_scene::geometry::nearest_receivers::nearest_receivers;
use app_scene::geometry::used_lights::UsedLights;
use app_scene::scene::{Light, MAX_RECEIVERS, Receiver};

/// Supported receivers.
pub(crate) struct Receivers {
    /// The [`MAX_RECEIVERS`] nearest to the toy, the nearest first, anchored near it.
    pub(crate) anchored: Vec<AnchoredReceiver>,
    /// Their indices in the scene's list.
    pub(crate) indices: Vec<usize>,
    /// Warning about those that are left out.
    pub(crate) warning: Option<Warning>,
}

impl Receivers {
    /// Selects receivers for a toy around `toy_in_world`, within a box of `corners_in_world`,
    /// independently of their order in the list.
    pub(crate) fn new(receivers: &[Receiver], toy_in_world: DVec3, corners_in_world: &[DVec3]) -> Self {
        let mut indices = nearest_receivers(receivers, corners_in_world);
        let left_out: Vec<usize> = indices.drain(MAX_RECEIVERS.min(receivers.len())..).collect();
        let anchored = indices
            .iter()
            .map(|index| AnchoredReceiver::near(&receivers[*index], toy_in_world));
        Self {
            anchored: anchored.collect(),
            warning: (!left_out.is_empty()).then(|| Warning::ReceiversLeftOut {
                names: left_out
                    .iter()
                    .map(|index| receivers[*index].name.clone())
                    .collect(),
            }),
            indices,
        }
    }
}

/// Supported lights.
pub(crate) struct Lights {
    /// The list from which they are selected: the scene's, or a frame's own.
    pub(crate) listed: Vec<Light>,
    /// The used ones.
    pub(crate) used: Vec<Light>,
    /// Indices of `used` in `listed`.
    pub(crate) indices: Vec<usize>,
    /// Warnings about those that are left out.
    pub(crate) warnings: Vec<Warning>,
}

impl Lights {
    pub(crate) fn new(listed: &[Light], receivers: &[AnchoredReceiver]) -> Self {
        let planes_from_world: Vec<DMat4> = receivers
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse())
            .collect();
        let used = UsedLights::new(listed, &planes_from_world);
        let used_of_list = used.of(listed);
        let mut warnings = Vec::new();
        if !used.below.is_empty() {
            warnings.push(Warning::LightsBelowReceivers { lights: used.below });
        }
        if used.n_left_out > 0 {
            warnings.push(Warning::LightsLeftOut {
                n_lights: used.n_left_out,
            });
        }
        Self {
            listed: listed.to_vec(),
            used: used_of_list,
            indices: used.indices,
            warnings,
        }
    }
}
