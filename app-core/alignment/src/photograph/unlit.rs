//! Judges lights by the loss that they leave in a photograph, one list after the other.

use std::sync::Arc;

use glam::DMat4;

use super::Photograph;
use crate::lights::{self, Counted, Unlit, Watched};
use crate::shape::Shape;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, Scene};
use app_scene::toy::{Toy, ToyError};

/// A photograph without any light, for a toy in its place.
#[derive(Debug)]
pub(super) struct UnlitToy {
    toy: Arc<Toy>,
    world_from_object: DMat4,
    /// `None` if too little of the receivers is visible, or without a plate.
    unlit: Option<Unlit>,
}

impl UnlitToy {
    fn is_of(&self, scene: &Scene, input: &FrameInput) -> bool {
        Arc::ptr_eq(&self.toy, &scene.toy) && self.world_from_object == input.world_from_object
    }
}

impl Photograph {
    /// The loss that lights leave, with the toy in its place; `None` if too little of the receivers
    /// is visible.
    pub(crate) fn watch(
        &self,
        scene: &Scene,
        input: &FrameInput,
        lights: (&[Light], Counted),
    ) -> Result<Option<Watched>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let known = self.unlit.get_or_init(|| self.unlit(scene, input, &shape));
        let anew = (!known.is_of(scene, input)).then(|| self.unlit(scene, input, &shape));
        let unlit = anew.as_ref().unwrap_or(known).unlit.as_ref();
        Ok(unlit.and_then(|unlit| {
            let posed = (&shape, &self.receivers[..]);
            lights::watch(lights, unlit, posed, &self.camera_from_world)
        }))
    }

    fn unlit(&self, scene: &Scene, input: &FrameInput, shape: &Shape) -> UnlitToy {
        let posed = (shape, &self.receivers[..]);
        UnlitToy {
            toy: Arc::clone(&scene.toy),
            world_from_object: input.world_from_object,
            unlit: Unlit::of(posed, &self.pyramid, &self.camera_from_world),
        }
    }
}
