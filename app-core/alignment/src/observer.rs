//! Observes a photograph's other properties if camera, toy and lights stay as given.

use super::error::{self, AlignError};
use super::photograph::Photograph;
use app_scene::frame::FrameInput;
use app_scene::gloss::Gloss;
use app_scene::scene::Scene;

/// Observes frames that are shown as given.
#[derive(Debug, Default)]
pub struct Observer {
    latest: Option<FrameInput>,
    /// How glossy the toy is, once that was looked for.
    gloss: Option<Gloss>,
}

impl Observer {
    /// A frame with its observations. The same frame as the one before costs nothing.
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
                .with_sharpness(latest.sharpness)
                .with_reflection(latest.reflection)
                .with_gloss(latest.gloss),
            None => self.looked_at(scene, input)?,
        };
        self.latest = Some(observed.clone());
        Ok(observed)
    }

    fn looked_at(&mut self, scene: &Scene, input: &FrameInput) -> Result<FrameInput, AlignError> {
        let photograph = Photograph::new(scene, input, None);
        let sharpness = photograph.sharpness_as_given(scene, &input.world_from_object)?;
        // Things are detected against an equally soft plate.
        let photograph = photograph.with_plate_as_soft(sharpness.plate_spread);
        let lights = input.lights_in(scene);
        let reflection = photograph.reflection(scene, input, &lights)?;
        // And on a receiver as if it were matt.
        let freed = match &reflection {
            Some(found) => Some(photograph.freed_of(scene, input, found)?),
            None => None,
        };
        let photograph = freed.as_ref().unwrap_or(&photograph);
        let things = photograph.things(scene, input, &lights)?;
        let gloss = match self.gloss {
            Some(gloss) => gloss,
            None => {
                let clear = things.as_ref().map(|things| photograph.clear_of(things));
                let photograph = clear.as_ref().unwrap_or(photograph);
                photograph.gloss(scene, &input.world_from_object, &lights)?
            }
        };
        self.gloss = Some(gloss);
        let input = input.clone().with_things(things).with_sharpness(sharpness);
        let reflection = reflection.map(|found| found.reflection);
        Ok(input.with_reflection(reflection).with_gloss(gloss))
    }
}
