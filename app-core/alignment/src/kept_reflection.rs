//! How the receiver that the toy stands on reflects, once it was looked for: it belongs to the place.

use super::Aligner;
use super::lights::FoundReflection;
use super::view::Seen;
use app_scene::scene::Light;
use app_scene::toy::ToyError;

/// A reflection is looked for with a pose whose outline is no farther from the picture's, in pixels: what it explains tells whether it
/// is there.
const REFLECTION_OUTLINE_PX: f64 = 1.5;

/// What is known of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeptReflection {
    pub(super) found: Option<FoundReflection>,
    /// In a view that shows the toy.
    is_looked_for: bool,
}

impl Aligner {
    /// Looks for the reflection in the first view that shows the toy, in lights as far as these are known; returns whether it did.
    pub(super) fn look_for_reflection(&mut self, seen: &Seen, lights: &[Light]) -> Result<bool, ToyError> {
        let is_open = !self.reflection.is_looked_for && !self.are_shadows_withheld;
        if !is_open || !seen.view.is_trusted(REFLECTION_OUTLINE_PX) {
            return Ok(false);
        }
        self.reflection = KeptReflection {
            found: seen.photograph.reflection(&self.scene, &seen.input, lights)?,
            is_looked_for: true,
        };
        Ok(true)
    }

    /// The same in lights that were found since.
    pub(super) fn look_again(&mut self, seen: &Seen, lights: &[Light]) -> Result<(), ToyError> {
        self.reflection.found = seen.photograph.reflection(&self.scene, &seen.input, lights)?;
        Ok(())
    }

    /// A view as if the receiver that the toy stands on were matt; none if it is, as far as is known.
    pub(super) fn freed_of_reflection(&self, seen: &Seen) -> Result<Option<Seen>, ToyError> {
        let found = self.reflection.found.as_ref();
        found.map(|found| seen.freed_of(&self.scene, found)).transpose()
    }
}
