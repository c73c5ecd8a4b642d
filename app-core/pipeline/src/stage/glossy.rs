//! The toy's gloss in use.

use super::Stage;
use crate::frame::warning::Warning;
use crate::gpu::Gpu;
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::gloss::Gloss;

impl Stage {
    /// Sets the toy's gloss. If it changes, the learned state is dropped. The baseline ignores
    /// gloss.
    pub(super) fn take_gloss(&mut self, gpu: &Gpu, input: &FrameInput) {
        let gloss = match self.settings {
            Settings::Model(_) if !input.gloss.is_none() => input.gloss,
            Settings::Model(_) | Settings::Baseline(_) => Gloss::NONE,
        };
        if std::mem::replace(&mut self.gloss, gloss) != gloss {
            self.drop_method(gpu);
        }
    }

    /// Angular radius of each light in use, seen from the toy.
    pub(super) fn angular_radii_rad(&self) -> Vec<f64> {
        let toy_in_world = self
            .world_from_object
            .transform_point3(self.bounds_in_object.centre());
        let lights = self.lights.used.iter();
        lights
            .map(|light| light.angular_radius_rad_from(toy_in_world))
            .collect()
    }

    pub(super) fn gloss_warning(&self) -> Option<Warning> {
        self.gloss.is_beyond_model().then(|| Warning::TooGlossy {
            roughness: self.gloss.roughness,
            strength: self.gloss.strongest(),
        })
    }
}
