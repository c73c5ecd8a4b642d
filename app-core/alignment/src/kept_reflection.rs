//! Reflection of the receiver below the toy, kept after its estimate: it belongs to the place.

use super::Aligner;
use super::lights::FoundReflection;
use super::view::Seen;
use app_scene::scene::Light;
use app_scene::toy::ToyError;

/// Largest distance in pixels between the outlines of pose and picture at which a reflection is
/// estimated: a worse pose cannot show whether there is one.
const REFLECTION_OUTLINE_PX: f64 = 1.5;

/// The estimate so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeptReflection {
    pub(super) found: Option<FoundReflection>,
    /// Whether it was estimated in a view that shows the toy.
    is_looked_for: bool,
}

impl Aligner {
    /// Estimates the reflection in the first view that shows the toy, with the known lights.
    /// Returns whether it did.
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

    /// Estimates it again with lights that were found later.
    pub(super) fn look_again(&mut self, seen: &Seen, lights: &[Light]) -> Result<(), ToyError> {
        self.reflection.found = seen.photograph.reflection(&self.scene, &seen.input, lights)?;
        Ok(())
    }

    /// A view as if the receiver below the toy were matt; `None` if the receiver is matt or not yet
    /// known to reflect.
    pub(super) fn freed_of_reflection(&self, seen: &Seen) -> Result<Option<Seen>, ToyError> {
        let found = self.reflection.found.as_ref();
        found.map(|found| seen.freed_of(&self.scene, found)).transpose()
    }
}
