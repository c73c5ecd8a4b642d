//! Lights in a view where things catch so much of the toy's shadow that lights alone do not explain
//! it.
//!
//! Such lights are a compromise between the shadow on the table and the displaced one on a thing:
//! by 4 to 19 degrees in nine captures of books and ramps without any known light, so that no plane
//! was found under them. Parts of the table that show the lights by themselves are tried instead:
//! that around the toy's base, and all but the things.

use std::sync::Arc;

use super::Aligner;
use super::kept_lights::KeptLights;
use super::light_search::Looked;
use super::view::Seen;
use crate::things::Colored;
use app_scene::scene::Light;
use app_scene::things::Things;
use app_scene::toy::ToyError;

/// What explains a view that lights alone do not.
pub(super) enum Explained {
    /// Planes of things, which are among the receivers of this view.
    Planes(Box<Seen>),
    /// Lights beside things.
    Lights(Box<KeptLights>),
}

impl Aligner {
    /// Planes of things, or lights beside things, that explain a view; `None` if there are none.
    /// `things` are those in lights that do not.
    pub(super) fn explained_by_things(
        &mut self,
        given: &Arc<[Light]>,
        (seen, things): (&Seen, Option<Things>),
        planes_of: Option<Colored>,
    ) -> Result<Option<Explained>, ToyError> {
        let mut all_things: Vec<Things> = things.into_iter().collect();
        if let Some(photograph) = seen.photograph.around_base(&self.scene, &seen.input)? {
            let lights = self.find_lights(Arc::clone(given), &seen.with_photograph(photograph))?;
            if lights.are_found() {
                match self.tried_planes(given, (&lights, seen), planes_of)? {
                    Looked::Planes(again) => return Ok(Some(Explained::Planes(again))),
                    Looked::Things(things) => all_things.extend(things),
                }
            }
        }
        let mut explained = None;
        for things in all_things {
            let lights = self.find_lights(Arc::clone(given), &seen.clear_of(&things))?;
            if !lights.are_found() || lights.leave_too_much() {
                continue;
            }
            if let Looked::Planes(again) = self.tried_planes(given, (&lights, seen), planes_of)? {
                return Ok(Some(Explained::Planes(again)));
            }
            explained = explained.or(Some(Explained::Lights(Box::new(lights))));
        }
        Ok(explained)
    }

    /// Things in some lights; or planes of them, which are kept if lights explain the view with
    /// them.
    pub(super) fn tried_planes(
        &mut self,
        given: &Arc<[Light]>,
        (lights, seen): (&KeptLights, &Seen),
        planes_of: Option<Colored>,
    ) -> Result<Looked, ToyError> {
        let before = (self.planes.clone(), Arc::clone(&self.scene));
        let looked = self.look_for_things(lights.in_use(), seen, planes_of)?;
        let Looked::Planes(again) = &looked else {
            return Ok(looked);
        };
        // Lights that explain it need no search.
        let left = self.watch(lights, again)?;
        if left.is_some_and(KeptLights::leaves_too_much)
            && self.find_lights(Arc::clone(given), again)?.leave_too_much()
        {
            (self.planes, self.scene) = before;
            return self.look_for_things(lights.in_use(), seen, None);
        }
        Ok(looked)
    }

    /// The lights by the shadow beside all listed tops; `None` if none is listed, or if the ground
    /// does not show the lights.
    ///
    /// A light that is fitted to a top that is listed too low agrees with it: with a book listed 2 mm
    /// too low it was 1.2 degrees and 15 % of its distance off, and half a millimetre of the height
    /// was corrected.
    pub(super) fn lights_on_ground(
        &self,
        given: &Arc<[Light]>,
        seen: &Seen,
    ) -> Result<Option<KeptLights>, ToyError> {
        let Some(photograph) = seen.photograph.without_tops() else {
            return Ok(None);
        };
        let lights = self.find_lights(Arc::clone(given), &seen.with_photograph(photograph))?;
        Ok(lights.are_found().then_some(lights))
    }
}
