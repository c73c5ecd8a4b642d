//! The style of the shown shadow, and its differences from the physical shadow.

use glam::Vec4;

use super::Stage;
use super::method::Method;
use crate::geometry::view::View;
use crate::gpu::Gpu;
use crate::model::plan::Plan;
use crate::plan::Change;
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::scene::Light;
use app_scene::shadow_style::ShadowStyle;

/// Factor by which the lights are widened, so that the work region contains both the real shadow
/// and the shown one.
fn widening(style: ShadowStyle) -> f64 {
    style.softness.max(1.0)
}

impl Stage {
    /// Sets the style of a frame's shadow; the baseline draws shadows as published.
    pub(super) fn take_shadow_style(&mut self, input: &FrameInput) {
        let style = match self.settings {
            Settings::Model(_) => input.shadow_style,
            Settings::Baseline(_) => ShadowStyle::TRUE,
        };
        if widening(style) != widening(self.shadow_style) {
            self.cached_footprint = None;
        }
        self.shadow_style = style;
    }

    /// The lights whose shadows the work region must contain.
    pub(super) fn reaching_lights(&self) -> Vec<Light> {
        self.lights_times(widening(self.shadow_style))
    }

    /// Applies the frame's style to the method's shadows, if the style or the view changed.
    pub(super) fn style_shadow(&mut self, gpu: &Gpu, change: Change) {
        if self.drawn_style == self.shadow_style && change < Change::View {
            return;
        }
        self.drawn_style = self.shadow_style;
        let style = self.shadow_style;
        let Some(state) = &self.state else { return };
        let Method::Model(model) = &state.method else {
            return;
        };
        let points = (style.softness != 1.0).then(|| self.softened_points(&model.region.plan, &state.view));
        if let Some(Method::Model(model)) = self.state.as_mut().map(|state| &mut state.method) {
            #[allow(clippy::cast_possible_truncation, reason = "from 0 to 4")]
            model.style_shadow(gpu, style.strength as f32, points);
        }
    }

    /// Points over the lights for the shown shadow, receiver by receiver, and the eyes that see the
    /// toy reflected in a view.
    fn softened_points(&self, plan: &Plan, view: &View) -> Vec<Vec<Vec4>> {
        let lights = self.lights_times(self.shadow_style.softness);
        let lights = lights.iter().zip(&plan.n_light_points);
        lights
            .map(|(light, n_points)| self.points_of(light, *n_points))
            .chain(self.mirrored_eyes(plan, view))
            .collect()
    }

    /// The lights with their widths multiplied by a factor, as seen from the toy.
    fn lights_times(&self, factor: f64) -> Vec<Light> {
        let toy_in_world = self
            .layout()
            .world_from_anchor()
            .transform_point3(self.toy_in_anchor());
        let widened = |light: &Light| match factor {
            1.0 => *light,
            _ => light.widened(toy_in_world, factor),
        };
        self.lights.used.iter().map(widened).collect()
    }
}
