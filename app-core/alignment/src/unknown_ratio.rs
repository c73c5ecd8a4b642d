//! The ratio that an aligner estimates before all else, on request: focal length or scale, or a lens.

use std::sync::Arc;

use super::error::{self, AlignError};
use super::report::LensAlignment;
use super::{Aligner, ratio};
use app_scene::frame::FrameInput;
use app_scene::geometry::used_lights::UsedLights;
use app_scene::scene::{Light, Scene};

impl Aligner {
    /// The input with the estimated focal length or scale; it is estimated in each new view until one shows it.
    pub(super) fn with_ratio(
        &mut self,
        input: &FrameInput,
        given: &Arc<[Light]>,
    ) -> Result<FrameInput, AlignError> {
        let is_view_known = self.view.as_ref().is_some_and(|view| view.is_of(input));
        let is_withheld = self.are_shadows_withheld && self.lights.is_some();
        if self.ratio.is_open() && !is_view_known && !is_withheld {
            let lights = self.about(given, input)?;
            let mut scene = Scene::clone(&self.given);
            if self.ratio.find(&mut scene, input, &lights) {
                // What earlier views told depends on the wrong ratio.
                *self = Self {
                    ratio: std::mem::take(&mut self.ratio),
                    reported_scene: Arc::clone(&self.reported_scene),
                    are_shadows_withheld: self.are_shadows_withheld,
                    ..Self::new(scene)
                };
            }
        }
        Ok(input
            .clone()
            .with_camera(self.ratio.camera(&input.camera))
            .with_world_from_object(self.ratio.pose(&input.world_from_object)))
    }

    /// Estimates the distortion of the lens of a frame and its plates, as if they were a pinhole's: two radial terms.
    /// Remove it from all photographs before aligning them (`Capture::open_with_lens` of a session).
    ///
    /// # Errors
    /// As [`Self::align`].
    pub fn lens(&self, input: &FrameInput) -> Result<LensAlignment, AlignError> {
        error::check(&self.scene, input)?;
        let listed = input.lights_in(&self.scene);
        let used = UsedLights::near(&self.scene, &listed, &input.world_from_object);
        let given = used.of(&listed);
        let lights = self.about(&given, input)?;
        Ok(ratio::find_lens(&self.scene, input, &lights))
    }

    /// Approximate lights: as given, or as estimated with the given focal length.
    fn about(&self, given: &Arc<[Light]>, input: &FrameInput) -> Result<Arc<[Light]>, AlignError> {
        if !given.is_empty() {
            return Ok(Arc::clone(given));
        }
        let found = Self::new(Arc::clone(&self.scene)).align(input)?;
        Ok(found.lights.unwrap_or_default())
    }
}
