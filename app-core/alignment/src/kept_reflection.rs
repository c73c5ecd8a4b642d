//! The reflection of the receiver below the toy, once it was searched for: it belongs to the place.

use super::lights::FoundReflection;
use super::photograph::Photograph;
use super::things::is_of_wrong_plate;
use super::view::Seen;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, Scene};
use app_scene::things::Things;
use app_scene::toy::ToyError;

/// Largest distance of the outlines in pixels at which a reflection is searched for: a worse pose
/// cannot show whether there is one.
const REFLECTION_OUTLINE_PX: f64 = 1.5;

/// A reflection that is kept from view to view.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeptReflection {
    pub(super) found: Option<FoundReflection>,
    /// Whether a view that shows the toy was searched.
    is_searched_for: bool,
}

impl KeptReflection {
    /// Searches the first view that shows the toy, under the lights known so far. Returns whether
    /// it did.
    pub(super) fn search(&mut self, scene: &Scene, seen: &Seen, lights: &[Light]) -> Result<bool, ToyError> {
        let is_shown = seen.view.is_trusted(REFLECTION_OUTLINE_PX);
        Ok(is_shown && self.search_first(scene, (&seen.photograph, &seen.input), lights)?)
    }

    /// Searches the first photograph that shows the toy in its place. Returns whether it did.
    pub(super) fn search_first(
        &mut self,
        scene: &Scene,
        seen: (&Photograph, &FrameInput),
        lights: &[Light],
    ) -> Result<bool, ToyError> {
        if self.is_searched_for {
            return Ok(false);
        }
        self.search_again(scene, seen, lights)?;
        self.is_searched_for = true;
        Ok(true)
    }

    /// Searches a photograph under other lights: without what the plate alone shows there, if it seems to be reflected.
    pub(super) fn search_again(
        &mut self,
        scene: &Scene,
        (photograph, input): (&Photograph, &FrameInput),
        lights: &[Light],
    ) -> Result<(), ToyError> {
        self.found = photograph.reflection(scene, input, lights)?;
        if self.found.is_none() {
            return Ok(());
        }
        let sighted = photograph.things(scene, input, lights, (None, None))?;
        let wrong = sighted.things.map(|things| things.only(is_of_wrong_plate));
        if let Some(wrong) = wrong.filter(Things::has_any) {
            let clear = photograph.clear_of(&wrong);
            self.found = clear.reflection(scene, input, lights)?;
        }
        Ok(())
    }

    /// A view as if the receiver below the toy were matt; `None` if it is matt, according to the
    /// pictures.
    pub(super) fn removed_from(&self, scene: &Scene, seen: &Seen) -> Result<Option<Seen>, ToyError> {
        let found = self.found.as_ref();
        found.map(|found| seen.freed_of(scene, found)).transpose()
    }
}
