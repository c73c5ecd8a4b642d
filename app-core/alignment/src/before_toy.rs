//! A second look at the toy if something stands before it, or if its plate is wrong: a part of its
//! outline is then not its own, and no pose fits, or a blur seems to.

use std::sync::{Arc, Weak};

use super::Aligner;
use super::kept_lights::KeptLights;
use super::photograph::{EstimatedLights, MOST_OUTLINE_PX, Photograph};
use super::picture::Pyramid;
use super::things::is_of_wrong_plate;
use super::view::Seen;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, Scene};
use app_scene::things::{Mark, Things};
use app_scene::toy::ToyError;

/// Lights that were searched anywhere in a view with all of its things.
#[derive(Debug)]
pub(super) struct LightsOfView {
    scene: Arc<Scene>,
    pyramid: Weak<Pyramid>,
    pub(super) found: EstimatedLights,
}

impl LightsOfView {
    /// Whether a view has the same pictures of the same scene, and so these lights.
    pub(super) fn are_of(&self, scene: &Arc<Scene>, seen: &Seen) -> bool {
        let pyramid = Arc::downgrade(seen.photograph.pyramid());
        Arc::ptr_eq(&self.scene, scene) && self.pyramid.ptr_eq(&pyramid)
    }
}

impl Aligner {
    /// The view again without the pixels that do not show the toy or its plate, if its outline does
    /// not fit with them, or only a blurred one does, and if it fits without them. A toy in a wrong
    /// pose looks as if something stood before it, too, but the rest of its outline does not fit.
    pub(super) fn past_things(
        &mut self,
        seen: Seen,
        input: &FrameInput,
        (kept, given): (Option<&KeptLights>, &[Light]),
    ) -> Result<Seen, ToyError> {
        let is_trusted = seen.view.is_trusted(MOST_OUTLINE_PX);
        if self.are_shadows_withheld || seen.view.report.is_none() || (is_trusted && is_sharp(&seen)) {
            return Ok(seen);
        }
        // In a first view without a list, lights are estimated with the thing in the picture.
        let found = if kept.is_none() && given.is_empty() {
            Some(self.find_anywhere(Arc::from([]), &seen)?)
        } else {
            None
        };
        let discovered = found.as_ref().and_then(|found| found.discovered.clone());
        self.lights_of_view = discovered.map(|found| LightsOfView {
            scene: Arc::clone(&self.scene),
            pyramid: Arc::downgrade(seen.photograph.pyramid()),
            found,
        });
        let lights = kept.or(found.as_ref()).map_or(given, KeptLights::in_use);
        let sighted = seen
            .photograph
            .things(&self.scene, &seen.input, lights, (None, None))?;
        let misleading = sighted.things.map(|things| things.only(is_misleading));
        let Some(misleading) = misleading.filter(Things::has_any) else {
            return Ok(seen);
        };
        let as_given = seen.input.clone().with_world_from_object(input.world_from_object);
        // The first look made the plate as soft as the outline seemed.
        let people = seen.view.people.as_ref();
        let clear = Photograph::without(&self.scene, &as_given, people.map(AsRef::as_ref))
            .clear_of(&misleading.only(|mark| !is_of_wrong_plate(mark)))
            .with_mended_plate(&self.scene, &as_given, &misleading)?;
        let again = self.posed(
            (clear, people.cloned()),
            input,
            (as_given, seen.view.camera_report),
        )?;
        if !again.view.is_trusted(MOST_OUTLINE_PX) || (is_trusted && !is_sharp(&again)) {
            return Ok(seen);
        }
        Ok(Seen::again(&self.scene, again.view, input))
    }
}

/// Whether the outline is no softer than the texture around it.
fn is_sharp(seen: &Seen) -> bool {
    let sharpness = &seen.view.sharpness;
    sharpness.outline_spread == sharpness.plate_spread
}

/// Whether an outline at such a mark is not that of the toy before its plate.
fn is_misleading(mark: Mark) -> bool {
    matches!(
        mark,
        Mark::BeforeToy | Mark::WrongPlate | Mark::CompletedPlate { .. } | Mark::ShadedPlate { .. }
    )
}
