//! Observes a photograph's other properties if camera, toy and lights stay as given.

use super::error::{self, AlignError};
use super::photograph::Photograph;
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// Observes frames that are shown as given.
#[derive(Debug, Default)]
pub struct Observer {
    latest: Option<FrameInput>,
}

impl Observer {
    /// A frame with its observations. The same frame as the one before costs nothing.
    ///
    /// # Errors As [`Aligner::align`](crate::Aligner::align).
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
            None => observed(scene, input)?,
        };
        self.latest = Some(observed.clone());
        Ok(observed)
    }
}

fn observed(scene: &Scene, input: &FrameInput) -> Result<FrameInput, AlignError> {
    let photograph = Photograph::new(scene, input, None);
    let sharpness = photograph.sharpness_as_given(scene, &input.world_from_object)?;
    // Things are detected against an equally soft plate.
    let photograph = photograph.with_plate_as_soft(sharpness.plate_spread);
    let things = photograph.things(scene, input, &input.lights_in(scene))?;
    Ok(input.clone().with_things(things).with_sharpness(sharpness))
}
