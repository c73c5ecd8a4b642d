//! What a photograph shows beside camera, toy and lights, where these stay as they are given.

use std::sync::Arc;

use super::error::{self, AlignError};
use super::photograph::Photograph;
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;
use app_scene::things::Things;

/// Looks at frames that are shown as they are given.
#[derive(Debug, Default)]
pub struct Observer {
    latest: Option<(FrameInput, Option<Things>)>,
}

impl Observer {
    /// A frame with what its picture shows. The same frame as the one before costs nothing.
    ///
    /// # Errors
    /// As [`Aligner::align`](crate::Aligner::align).
    pub fn observed(&mut self, scene: &Scene, input: &FrameInput) -> Result<FrameInput, AlignError> {
        error::check(scene, input)?;
        let latest = self.latest.as_ref().filter(|(latest, _)| {
            latest.image.is(&input.image)
                && latest.camera == input.camera
                && latest.world_from_object == input.world_from_object
                && latest.lights == input.lights
        });
        let things = match latest {
            Some((_, things)) => things.clone(),
            None => {
                let lights = match &input.lights {
                    Some(lights) => Arc::clone(lights),
                    None => scene.lights.as_slice().into(),
                };
                Photograph::new(scene, input, None).things(scene, input, &lights)?
            }
        };
        self.latest = Some((input.clone(), things.clone()));
        Ok(input.clone().with_things(things))
    }
}
