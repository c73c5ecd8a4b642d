//! The pose by outline and shadows together, once the lights are found.

use std::sync::Arc;

use glam::DMat4;

use super::Aligner;
use super::kept_lights::KeptLights;
use super::lights::{Joined, OfOutline, joined};
use super::photograph::{MOST_OUTLINE_PX, Photograph, apart, middle_of_toy};
use super::pose::{LEAST_EVIDENCE, stand};
use super::report::Stand;
use super::view::Seen;
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, LightUncertainty, PoseUncertainty, Scene, Uncertainty};
use app_scene::toy::ToyError;

impl Aligner {
    /// Finds or watches the lights of a view; in the first one that shows the toy at its place they correct its pose.
    pub(super) fn with_lights(
        &mut self,
        mut seen: Seen,
        kept: Option<KeptLights>,
        given: Arc<[Light]>,
    ) -> Result<Seen, ToyError> {
        let is_known = |kept: &KeptLights| kept.are_settled || self.are_shadows_withheld;
        let (is_first, before) = (!kept.as_ref().is_some_and(is_known), Arc::clone(&self.scene));
        let mut lights = match kept {
            Some(kept) if self.are_shadows_withheld => kept,
            kept => self.look_at_lights(kept, given, &seen)?,
        };
        // The view has the receivers and plates of before.
        if is_first && Arc::ptr_eq(&before, &self.scene) {
            self.join_shadow(&mut seen, &mut lights)?;
        }
        self.lights = Some(lights);
        Ok(seen)
    }

    /// Moves the toy and the lights of a view by what the shadows show, if the outline has moved the toy and the lights
    /// explain the shadows.
    ///
    /// Measured: a toy that is out of focus by 2 px was .39 mm off along the view, which its light took on; the
    /// shadow's error, low-passed, fell from 1.35 times the exact pose's to 1.16.
    fn join_shadow(&self, seen: &mut Seen, lights: &mut KeptLights) -> Result<(), ToyError> {
        let Some(covariance) = seen.view.covariance else {
            return Ok(());
        };
        let Uncertainty {
            toy, lights: bounds, ..
        } = &self.scene.uncertainty;
        let is_open = *toy == PoseUncertainty::default() && *bounds == LightUncertainty::default();
        if !is_open || !seen.view.is_trusted(MOST_OUTLINE_PX) || !lights.explain_shadows() {
            return Ok(());
        }
        let freed = self.reflection.removed_from(&self.scene, seen)?;
        let looked_at = freed.as_ref().unwrap_or(&*seen);
        let clear = self.things.as_ref().map(|things| looked_at.clear_of(things));
        let photograph = &clear.as_ref().unwrap_or(looked_at).photograph;
        let outline = OfOutline {
            covariance: &covariance,
            most_evidence: LEAST_EVIDENCE,
        };
        let known = (lights.in_use(), &outline);
        let Some(Joined {
            motion,
            lights: found,
        }) = photograph.joined(&self.scene, &seen.input, known)?
        else {
            return Ok(());
        };
        if found.iter().any(|light| light.check("lights").is_err()) {
            return Ok(());
        }
        let camera = seen.input.camera.world_from_camera;
        let world_from_object = camera * motion * camera.inverse() * seen.input.world_from_object;
        let middle = middle_of_toy(&self.scene)?;
        let stand = photograph.stand(&self.scene, &world_from_object)?;
        if let Some(report) = &mut seen.view.report {
            (report.moved_m, report.turned_rad) = apart(&seen.view.given, &world_from_object, middle);
            report.stand = stand.or(report.stand);
        }
        lights.move_to(found.into(), world_from_object.transform_point3(middle));
        // The shadows count once.
        seen.view.covariance = None;
        seen.view.world_from_object = world_from_object;
        seen.input.world_from_object = world_from_object;
        Ok(())
    }
}

impl Photograph {
    /// The toy's position on its ground; `None` if it floats.
    fn stand(&self, scene: &Scene, world_from_object: &DMat4) -> Result<Option<Stand>, ToyError> {
        let shape = self.shape(scene, world_from_object)?;
        let ground = self.ground_under(scene, &shape);
        Ok(ground.and_then(|ground| stand(&shape, ground.plane)))
    }

    /// A step of pose and lights by outline and shadows; `None` if the shadows show none.
    fn joined(
        &self,
        scene: &Scene,
        input: &FrameInput,
        (lights, outline): (&[Light], &OfOutline<'_>),
    ) -> Result<Option<Joined>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let world_from_camera = &input.camera.world_from_camera;
        Ok(joined(lights, self.seen(&shape), outline, world_from_camera))
    }
}
