//! Observes a photograph's other properties if camera, toy and lights stay as given.

use std::sync::Arc;

use super::error::{self, AlignError};
use super::found_planes::FoundPlanes;
use super::kept_reflection::KeptReflection;
use super::lights::FoundReflection;
use super::photograph::Photograph;
use super::report::PlaneAlignment;
use super::things::Memory;
use app_scene::frame::FrameInput;
use app_scene::geometry::used_lights::UsedLights;
use app_scene::gloss::Gloss;
use app_scene::scene::{Light, Scene};
use app_scene::sharpness::Spread;

/// Observes frames of one scene that are shown as given.
#[derive(Debug, Default)]
pub struct Observer {
    latest: Option<FrameInput>,
    /// Gloss of the toy, from the first frame that shows it at its place.
    gloss: Option<Gloss>,
    planes: FoundPlanes,
    /// Memory of the search for things in the previous picture.
    memory: Option<Memory>,
    /// The reflection of the receiver under the toy, once it was searched for.
    reflection: KeptReflection,
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
            Some(latest) => input.clone().with_observations(latest.observations()),
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

    /// A scene with these planes among its receivers: the one to give to the core.
    #[must_use]
    pub fn scene(&self, scene: &Scene) -> Scene {
        let mut scene = Arc::new(scene.clone());
        self.planes.add_to(&mut scene);
        Arc::unwrap_or_clone(scene)
    }

    fn look(&mut self, scene: &Scene, input: &FrameInput) -> Result<FrameInput, AlignError> {
        let known = self.scene(scene);
        let photograph = Photograph::new(&known, input);
        let (sharpness, is_toy_seen) = photograph.sharpness_as_given(&known, &input.world_from_object)?;
        let grain = photograph.grain(sharpness.plate_spread);
        let listed = input.lights_in(&known);
        let used = UsedLights::near(&known, &listed, &input.world_from_object);
        let lights: Vec<Light> = used.of(&listed);
        // It belongs to the receiver under the toy: found planes and later frames do not change it.
        let soft = photograph.with_plate_as_soft(sharpness.plate_spread);
        if is_toy_seen {
            self.reflection.search_first(&known, (&soft, input), &lights)?;
        }
        let reflection = self.reflection.found;
        let look = Look {
            input,
            plate_spread: sharpness.plate_spread,
            reflection: reflection.as_ref(),
        };
        let mut photograph = look.freed(soft, &known)?;
        let planes_of = self.planes.wanted(true);
        let before = self.memory.take();
        let sighted = photograph.things(&known, input, &lights, (planes_of, before.as_ref()))?;
        let mut things = sighted.things;
        self.memory = sighted.memory;
        if planes_of.is_some() && things.is_some() && self.planes.take(sighted.planes, planes_of) {
            let known = self.scene(scene);
            photograph = look.photograph(&known)?;
            let sighted = photograph.things(&known, input, &lights, (None, before.as_ref()))?;
            (things, self.memory) = (sighted.things, sighted.memory);
        }
        // Without lights no highlight constrains it: a later frame may.
        if is_toy_seen && self.gloss.is_none() && !lights.is_empty() {
            let in_light = (&lights[..], things.as_ref());
            self.gloss = Some(photograph.gloss(scene, &input.world_from_object, in_light)?);
        }
        let gloss = self.gloss.unwrap_or(input.gloss);
        let input = input.clone().with_things(things).with_sharpness(sharpness);
        let given = input.grain;
        let input = input.with_grain(given.or(grain));
        let reflection = reflection.map(|found| found.reflection);
        Ok(input.with_reflection(reflection).with_gloss(gloss))
    }
}

/// The conditions of a frame.
pub(super) struct Look<'a> {
    pub(super) input: &'a FrameInput,
    pub(super) plate_spread: Spread,
    pub(super) reflection: Option<&'a FoundReflection>,
}

impl Look<'_> {
    /// The frame beside an equally soft plate, both as if the receiver under the toy were matt.
    pub(super) fn photograph(&self, scene: &Scene) -> Result<Photograph, AlignError> {
        let photograph = Photograph::new(scene, self.input).with_plate_as_soft(self.plate_spread);
        self.freed(photograph, scene)
    }

    /// A photograph beside its equally soft plate, both as if the receiver under the toy were matt.
    fn freed(&self, photograph: Photograph, scene: &Scene) -> Result<Photograph, AlignError> {
        Ok(match self.reflection {
            Some(found) => photograph.freed_of(scene, self.input, found)?,
            None => photograph,
        })
    }
}
