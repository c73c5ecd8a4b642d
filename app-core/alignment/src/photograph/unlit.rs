//! A photograph without any light, which does not change from one list of lights to the next.

use std::sync::Arc;

use glam::DMat4;

use crate::lights::Unlit;
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;
use app_scene::toy::Toy;

/// A photograph without any light, for a toy in its place.
#[derive(Debug)]
pub(super) struct UnlitToy {
    toy: Arc<Toy>,
    world_from_object: DMat4,
    /// `None` if too little of the receivers is visible, or without a plate.
    pub(super) unlit: Option<Unlit>,
}

impl UnlitToy {
    pub(super) fn new(scene: &Scene, input: &FrameInput, unlit: Option<Unlit>) -> Self {
        Self {
            toy: Arc::clone(&scene.toy),
            world_from_object: input.world_from_object,
            unlit,
        }
    }

    pub(super) fn is_of(&self, scene: &Scene, input: &FrameInput) -> bool {
        Arc::ptr_eq(&self.toy, &scene.toy) && self.world_from_object == input.world_from_object
    }
}
