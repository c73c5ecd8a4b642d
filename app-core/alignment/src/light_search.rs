//! Selects the lights of a view: listed ones, estimates near the list or anywhere, or an assumed
//! one.

use std::sync::Arc;

use super::Aligner;
use super::kept_lights::KeptLights;
use super::lights::{Counted, Watched};
use super::photograph::{MOST_OUTLINE_PX, Photograph};
use super::receivers::nearest;
use super::view::Seen;
use crate::no_light::NoLight;
use crate::things::{self, Colored};
use app_scene::scene::{Light, LightUncertainty, MAX_LIGHTS, Plate, Scene};
use app_scene::things::Things;
use app_scene::toy::ToyError;

/// Largest distance, in pixels, between the outlines of toy and picture for a search of lights.
///
/// Exact poses came out at up to 1.2, if a shadow beside the toy hides a part of the outline; 2
/// means another toy. With a model of a fifth of the triangles they came to 1.2: its listed light stayed 5 degrees off.
const DISCOVERY_OUTLINE_PX: f64 = 1.5;

/// Result of the search for other things.
pub(super) enum Looked {
    /// Things, if there are any.
    Things(Option<Box<Things>>),
    /// Planes of things: the view with these among the receivers.
    Planes(Box<Seen>),
}

impl Aligner {
    /// The lights in a view, as far as it constrains them.
    pub(super) fn find_lights(&self, given: Arc<[Light]>, seen: &Seen) -> Result<KeptLights, ToyError> {
        if given.is_empty() {
            return self.estimate_lights(given, seen);
        }
        let found = if self.can_tell_lights(&given) && seen.view.is_trusted(DISCOVERY_OUTLINE_PX) {
            seen.photograph
                .lights(&self.scene, &seen.input, (&given, &self.scene.uncertainty.lights))?
        } else {
            None
        };
        let lights = KeptLights::listed(given, found);
        let watched = self.watch(&lights, seen)?;
        match watched.filter(|left| KeptLights::leaves_too_much(*left)) {
            Some(left) => self.search_beyond_list((lights, left), seen),
            None => Ok(lights.seen(watched)),
        }
    }

    /// Lights anywhere, or a long one, if those near a list do not explain a view; the list, if
    /// others do not either.
    fn search_beyond_list(
        &self,
        (near, left): (KeptLights, Watched),
        seen: &Seen,
    ) -> Result<KeptLights, ToyError> {
        // If a list states the uncertainty of its directions, nothing is searched beyond.
        if self.scene.uncertainty.lights.direction_rad.is_none() {
            let others = self.find_anywhere(Arc::clone(&near.given), seen)?;
            let watched = self.watch(&others, seen)?;
            if watched.is_some_and(|watched| others.stand_in_for(watched, left)) {
                return Ok(others.seen(watched));
            }
            if let Some(line) = self.line_for((&near, left), seen)? {
                return Ok(line);
            }
        }
        let list = near.left_as_given();
        let watched = self.watch(&list, seen)?;
        Ok(list.seen(watched))
    }

    /// A line of lights in place of one that leaves too much of a view unexplained; `None` if it is
    /// no better.
    fn line_for(
        &self,
        (round, left): (&KeptLights, Watched),
        seen: &Seen,
    ) -> Result<Option<KeptLights>, ToyError> {
        let [light] = round.in_use() else {
            return Ok(None);
        };
        let Some(line) = seen.photograph.line_of(&self.scene, &seen.input, light)? else {
            return Ok(None);
        };
        let line = round.as_line(line);
        let watched = self.watch(&line, seen)?;
        let stands_in = watched.is_some_and(|watched| line.stand_in_for(watched, left));
        Ok(stands_in.then(|| line.seen(watched)))
    }

    /// Unlisted lights of a view, or lights that are not at their listed place.
    fn estimate_lights(&self, given: Arc<[Light]>, seen: &Seen) -> Result<KeptLights, ToyError> {
        let lights = self.find_anywhere(given, seen)?;
        let has_none = matches!(lights.discovered, Some(Err(NoLight::NoneDominant)));
        let lights = if has_none && lights.in_use().is_empty() {
            lights.or_assumed(seen.photograph.assume_wide(&self.scene, &seen.input)?)
        } else {
            lights
        };
        let watched = self.watch(&lights, seen)?;
        if let Some(left) =
            watched.filter(|watched| lights.are_found() && KeptLights::leaves_too_much(*watched))
            && let Some(line) = self.line_for((&lights, left), seen)?
        {
            return Ok(line);
        }
        Ok(lights.seen(watched))
    }

    /// Lights all over the hemisphere, or around a probe's estimates.
    pub(super) fn find_anywhere(&self, given: Arc<[Light]>, seen: &Seen) -> Result<KeptLights, ToyError> {
        let by_probe = self.probe.as_ref().map_or(&[][..], |probe| &probe.lights);
        let known = self.lights_of_view.as_ref();
        if let Some(known) = known.filter(|known| known.are_of(&self.scene, seen)) {
            return Ok(KeptLights::discovered(given, known.found.clone(), by_probe));
        }
        let found = match &seen.view.report {
            Some(pose) if seen.view.is_trusted(DISCOVERY_OUTLINE_PX) => {
                seen.photograph
                    .search_lights(&self.scene, &seen.input, &pose.deviation, by_probe)?
            }
            _ => Err(NoLight::PoseUnknown),
        };
        Ok(KeptLights::discovered(given, found, by_probe))
    }

    /// Lights of an earlier view, or new ones if a lamp was moved or switched on.
    pub(super) fn watch_lights(&mut self, mut kept: KeptLights, seen: &Seen) -> Result<KeptLights, ToyError> {
        let now = self.watch(&kept, seen)?;
        let is_asked_for = kept.watch(now);
        if !kept.are_found() && is_asked_for {
            let is_shown = self.scene.plates.is_empty() && seen.view.is_trusted(DISCOVERY_OUTLINE_PX);
            kept.n_unlit += u32::from(is_shown);
            if is_shown && !kept.n_unlit.is_power_of_two() {
                return Ok(kept);
            }
            let n_unlit = kept.n_unlit;
            let mut found = self.find_lights(kept.given, seen)?;
            found.n_unlit = n_unlit;
            return Ok(found);
        }
        let Some(now) = now.filter(|_| is_asked_for) else {
            return Ok(kept);
        };
        // Without things it is the same view.
        let moved = if kept.are_searched_beside_no_thing(now) {
            None
        } else {
            self.moved_lights(&kept, seen)?
        };
        Ok(moved.unwrap_or_else(|| kept.searched_in_vain(now)))
    }

    /// Lights in place of others that do not explain a view, beside plates in their light; `None` if none explain it as well
    /// as those did theirs.
    fn moved_lights(&mut self, kept: &KeptLights, seen: &Seen) -> Result<Option<KeptLights>, ToyError> {
        if kept.discovered.is_none() {
            // A moved lamp may be anywhere.
            let lights = (kept.in_use(), &LightUncertainty::default());
            let found = seen.photograph.lights(&self.scene, &seen.input, lights)?;
            let moved = KeptLights::listed(Arc::clone(&kept.given), found);
            if let Some(now) = self.watch(&moved, seen)?.filter(|now| kept.are_replaced_by(*now)) {
                return Ok(Some(moved.in_place_of(kept, now)));
            }
        }
        Ok(self.relight(kept, seen)?.map(|(lights, scene)| {
            (self.scene, self.is_relit) = (scene, true);
            lights
        }))
    }

    /// Lights in place of others that do not explain a view in which nothing counts as a thing; `None` if none do.
    fn moved_beside_no_thing(
        &mut self,
        kept: &mut KeptLights,
        seen: &Seen,
    ) -> Result<Option<KeptLights>, ToyError> {
        let now = self.watch(kept, seen)?;
        let Some(now) = now.filter(|now| kept.are_doubtful(*now)) else {
            return Ok(None);
        };
        let moved = self.moved_lights(kept, seen)?;
        if moved.is_none() {
            kept.searched_beside_no_thing_in_vain(Some(now));
        }
        Ok(moved)
    }

    /// The lights in a view, and the other things in it, which must not count as shadows.
    pub(super) fn look_at_lights(
        &mut self,
        mut kept: Option<KeptLights>,
        given: Arc<[Light]>,
        seen: &Seen,
    ) -> Result<KeptLights, ToyError> {
        // What an untrusted view before left is no result.
        let are_kept = kept.as_ref().is_some_and(|kept| kept.are_settled);
        let known: Arc<[Light]> = kept
            .as_ref()
            .map_or(Arc::clone(&given), |kept| kept.in_use().into());
        // If the toy's pose is wrong, the picture shows the place behind it, as if a thing stood in
        // front of the toy.
        let are_trusted = !self.are_shadows_withheld && seen.view.is_trusted(MOST_OUTLINE_PX);
        let as_it_is = seen;
        let before = Arc::clone(&self.scene);
        let is_searched = !self.are_shadows_withheld && self.reflection.search(&self.scene, seen, &known)?;
        let reflection = self.reflection.found;
        let freed = self.reflection.removed_from(&self.scene, seen)?;
        let seen = freed.as_ref().unwrap_or(seen);
        // A lamp that was moved comes first: the place of its old shadow looks like a thing, and so does its new shadow.
        let moved = match &mut kept {
            Some(kept) if are_kept && are_trusted => self.moved_beside_no_thing(kept, seen)?,
            _ => None,
        };
        let things = if !are_trusted || moved.is_some() {
            None
        } else {
            // A plane is not fitted under lights that may be degrees off.
            let planes_of = are_kept.then(|| self.planes.wanted(false)).flatten();
            match self.look_for_things(&known, seen, planes_of)? {
                Looked::Things(things) => things.map(|things| *things),
                Looked::Planes(again) => return self.look_at_lights(kept, given, &again),
            }
        };
        let clear = things.as_ref().map(|things| seen.clear_of(things));
        let looked_at = clear.as_ref().unwrap_or(seen);
        let mut lights = match (moved, kept) {
            (Some(moved), _) => moved,
            (None, Some(kept)) => self.watch_lights(kept, looked_at)?,
            (None, None) => self.find_lights(Arc::clone(&given), looked_at)?,
        };
        if is_searched && lights.in_use() != &*known {
            let seen = (&as_it_is.photograph, &as_it_is.input);
            self.reflection.search_again(&self.scene, seen, lights.in_use())?;
            // A shadow of unknown lights was taken for a reflection: its removal misled the lights.
            if freed.is_some() && self.reflection.found.is_none() && !are_kept {
                let clear = things.as_ref().map(|things| as_it_is.clear_of(things));
                lights = self.find_lights(Arc::clone(&given), clear.as_ref().unwrap_or(as_it_is))?;
            }
        }
        // In the first view planes are still to be found: on things, on what the lights do not explain, and sides below
        // listed tops.
        let is_plain = things.is_none() && self.scene.receivers.len() < 2 && lights.misfit().is_none();
        let are_settled = lights.in_use() == &*known && (are_kept || is_plain);
        let things = if !are_trusted || are_settled {
            things
        } else {
            // Plates may have been relit.
            let is_same = Arc::ptr_eq(&before, &self.scene);
            let relit = (!is_same).then(|| Seen::again(&self.scene, seen.view.clone(), &seen.input));
            let relit = relit.as_ref().unwrap_or(as_it_is);
            let is_freed = is_same && self.reflection.found == reflection;
            let again = (!is_freed).then(|| self.reflection.removed_from(&self.scene, relit));
            let again = again.transpose()?;
            let freed = again.as_ref().unwrap_or(&freed).as_ref().unwrap_or(relit);
            let planes_of = self.planes.wanted(!are_kept);
            // Listed planes are corrected before the lights trust them.
            if !are_kept
                && planes_of.is_some()
                && let Some(on_ground) = self.lights_on_ground(&given, looked_at)?
                && let Looked::Planes(again) = self.look_for_things(on_ground.in_use(), freed, planes_of)?
            {
                return self.look_at_lights(None, given, &again);
            }
            let looked = if are_kept {
                self.look_for_things(lights.in_use(), freed, planes_of)?
            } else {
                self.look_for_explanations(&given, &mut lights, (freed, planes_of))?
            };
            match looked {
                Looked::Things(things) => things.map(|things| *things),
                Looked::Planes(again) => {
                    return self.look_at_lights(are_kept.then_some(lights), given, &again);
                }
            }
        };
        self.adopt(lights, things, (seen, are_kept, are_trusted))
    }

    /// Adopts the lights and things of a view; `are_kept` are lights of an earlier one, and a trusted view shows the toy in
    /// its place.
    fn adopt(
        &mut self,
        mut lights: KeptLights,
        things: Option<Things>,
        (seen, are_kept, are_trusted): (&Seen, bool, bool),
    ) -> Result<KeptLights, ToyError> {
        // Without lights no highlight constrains it: a later view may.
        if are_trusted && self.gloss.is_none() && !lights.in_use().is_empty() {
            let toy = &seen.input.world_from_object;
            let in_light = (lights.in_use(), things.as_ref());
            self.gloss = Some(seen.photograph.gloss(&self.scene, toy, in_light)?);
        }
        lights.is_beside_thing = lights.is_list_that_leaves_too_much()
            && self.explain_own_shadows(&lights, (seen, things.as_ref()))?;
        lights.are_settled = are_kept || are_trusted;
        if !are_kept && things.is_some() {
            // Things leave as much unexplained in the next view: no search for others is due.
            lights.searched_beside_no_thing_in_vain(self.watch(&lights, seen)?);
        }
        things::adopt(&mut self.things, things);
        Ok(lights)
    }

    /// Things that stand beside the toy in given lights; or, once planes of some are found, the view with these among the receivers.
    pub(super) fn look_for_things(
        &mut self,
        lights: &[Light],
        seen: &Seen,
        planes_of: Option<Colored>,
    ) -> Result<Looked, ToyError> {
        let before = (planes_of, self.memories[0].as_ref());
        let sighted = seen.photograph.things(&self.scene, &seen.input, lights, before)?;
        self.memories[1] = sighted.memory;
        if planes_of.is_none() || sighted.things.is_none() || !self.planes.take(sighted.planes, planes_of) {
            return Ok(Looked::Things(sighted.things.map(Box::new)));
        }
        self.planes.add_latest_to(&mut self.scene);
        Ok(Looked::Planes(Box::new(Seen::again(
            &self.scene,
            seen.view.clone(),
            &seen.input,
        ))))
    }

    /// Lights that explain a view in place of those at the time of the plates, and the scene with
    /// plates in their light; `None` if they do not explain it as well.
    fn relight(&self, kept: &KeptLights, seen: &Seen) -> Result<Option<(KeptLights, Arc<Scene>)>, ToyError> {
        let scene = self.scene.as_ref();
        // Plates that were relit before have lost what was too bright or too dark for their codes.
        let given = scene.clone().with_plates(self.plates_as_given());
        let again = self
            .is_relit
            .then(|| Seen::again(&given, seen.view.clone(), &seen.input));
        let seen = again.as_ref().unwrap_or(seen);
        let Some(relight) = seen.photograph.relight(&given, &seen.input)? else {
            return Ok(None);
        };
        let toy = &seen.input.world_from_object;
        let relit = |plate: &Plate| relight.plate(plate, (&given, toy));
        // A view reads the nearest plate alone.
        let nearest = nearest(&given.plates, &seen.input.camera);
        let nearest = nearest.into_iter().take(1).map(relit).collect();
        let trial = Self::new(scene.clone().with_plates(nearest));
        let seen = Seen::again(&trial.scene, seen.view.clone(), &seen.input);
        let others = trial.estimate_lights(Arc::clone(&kept.given), &seen)?;
        let now = trial.watch(&others, &seen)?;
        Ok(now.filter(|now| kept.are_replaced_by(*now)).map(|now| {
            let plates = given.plates.iter().map(relit).collect();
            let scene = Arc::new(scene.clone().with_plates(plates));
            (others.in_place_of(kept, now), scene)
        }))
    }

    /// The plates as they were photographed, with their estimated cameras.
    fn plates_as_given(&self) -> Vec<Plate> {
        let both = self.given.plates.iter().zip(&self.scene.plates);
        let plates = both.map(|(given, Plate { camera, .. })| Plate {
            camera: *camera,
            image: Arc::clone(&given.image),
        });
        plates.collect()
    }

    /// The loss of lights in a view; `None` if the view does not constrain them.
    pub(super) fn watch(&self, lights: &KeptLights, seen: &Seen) -> Result<Option<Watched>, ToyError> {
        if !self.can_tell_lights(lights.in_use()) || !seen.view.is_trusted(DISCOVERY_OUTLINE_PX) {
            return Ok(None);
        }
        let lights = (lights.in_use(), Counted::All);
        seen.photograph.watch(&self.scene, &seen.input, lights)
    }

    /// Whether lights explain their own shadows beside other things, such as a hand, as far as the view
    /// shows these, or things hide them: what else it shows may be a part of a thing, or its shadow.
    fn explain_own_shadows(
        &self,
        lights: &KeptLights,
        (seen, things): (&Seen, Option<&Things>),
    ) -> Result<bool, ToyError> {
        let Some(things) = things else {
            return Ok(false);
        };
        let watch = |photograph: &Photograph| {
            let lights = (lights.in_use(), Counted::InShadows);
            photograph.watch(&self.scene, &seen.input, lights)
        };
        Ok(match watch(&seen.photograph.clear_of(things))? {
            Some(watched) => KeptLights::are_explained(watched),
            None => watch(&seen.photograph)?.is_some(),
        })
    }

    /// Whether pictures can constrain that number of listed lights: not without a plate.
    fn can_tell_lights(&self, lights: &[Light]) -> bool {
        lights.len() <= MAX_LIGHTS && !self.scene.plates.is_empty()
    }
}
