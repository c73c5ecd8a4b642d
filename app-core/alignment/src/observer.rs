//! What a photograph shows beside camera, toy and lights, where these stay as they are given.

use std::sync::Arc;

use super::error::{self, AlignError};
use super::found_planes::FoundPlanes;
use super::photograph::Photograph;
use super::report::PlaneAlignment;
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// Looks at frames of one scene that are shown as they are given.
#[derive(Debug, Default)]
pub struct Observer {
    latest: Option<FrameInput>,
    planes: FoundPlanes,
}

impl Observer {
    /// A frame with what its picture shows. The same frame as the one before costs nothing.
    ///
    /// # Errors
    /// As [`Aligner::align`](crate::Aligner::align).
    pub fn observed(&mut self, scene: &Scene, input: &FrameInput) -> Result<FrameInput, AlignError> {
        error::check(scene, input)?;
        let latest = self.latest.as_ref().filter(|latest| {
            latest.image.is(&input.image)
                && latest.camera == input.camera
                && latest.world_from_object == input.world_from_object
                && latest.lights == input.lights
        });
        let observed = match latest {
            Some(latest) => input
                .clone()
                .with_things(latest.things.clone())
                .with_sharpness(latest.sharpness),
            None => self.look(scene, input)?,
        };
        self.latest = Some(observed.clone());
        Ok(observed)
    }

    /// Planes of things that were found in the frames so far.
    #[must_use]
    pub fn planes(&self) -> &[PlaneAlignment] {
        &self.planes.report
    }

    /// A scene with these planes among its receivers: what the core is to be given.
    #[must_use]
    pub fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = Arc::new(scene.clone());
        self.planes.add_to(&mut scene);
        Arc::unwrap_or_clone(scene)
    }

    fn look(&mut self, scene: &Scene, input: &FrameInput) -> Result<FrameInput, AlignError> {
        let known = self.scene(scene);
        let photograph = Photograph::new(&known, input, None);
        let sharpness = photograph.sharpness_as_given(&known, &input.world_from_object)?;
        // Things are told by what a plate shows that is as soft.
        let photograph = photograph.with_plate_as_soft(sharpness.plate_spread);
        let wants_planes = self.planes.are_wanted();
        let lights = input.lights_in(&known);
        let sighted = photograph.things(&known, input, &lights, wants_planes)?;
        let things = if wants_planes && sighted.things.is_some() && self.planes.take(sighted.planes) {
            let known = self.scene(scene);
            let photograph = Photograph::new(&known, input, None).with_plate_as_soft(sharpness.plate_spread);
            photograph.things(&known, input, &lights, false)?.things
        } else {
            sighted.things
        };
        Ok(input.clone().with_things(things).with_sharpness(sharpness))
    }
}
