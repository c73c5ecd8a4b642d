//! The toy's image in a glossy receiver: which reflection is drawn, and the eyes behind the receiver that it is drawn from.

use glam::Vec4;

use super::Stage;
use crate::frame::warning::Warning;
use crate::geometry::view::View;
use crate::model::plan::Plan;
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::reflection::Reflection;
use app_scene::scene::MAX_LIGHTS;

/// A smoother receiver shows more of the toy than its mean colour.
const LEAST_ROUGHNESS: f64 = 0.05;

/// Below a receiver, as a homogeneous light: it casts no shadow there.
const NOWHERE: Vec4 = Vec4::NEG_Y;

impl Stage {
    /// Takes over how a frame says that the first receiver reflects; returns whether that is another way than before.
    pub(super) fn take_reflection(&mut self, input: &FrameInput) -> bool {
        let given = match self.settings {
            Settings::Model(_) => input.reflection,
            Settings::Baseline(_) => None,
        };
        std::mem::replace(&mut self.reflection, given) != given
    }

    /// How the first receiver reflects, where lights leave a channel of the visibilities.
    pub(super) fn reflection_in_use(&self) -> Option<&Reflection> {
        let has_channel = self.lights.used.len() < MAX_LIGHTS;
        self.reflection.as_ref().filter(|_| has_channel)
    }

    /// That it reflects too sharply for one colour of the toy.
    pub(super) fn reflection_warning(&self) -> Option<Warning> {
        let roughness = self.reflection_in_use()?.roughness;
        (roughness < LEAST_ROUGHNESS).then_some(Warning::MirrorLike { roughness })
    }

    /// The same with its channel.
    pub(super) fn reflection_channel(&self) -> Option<(&Reflection, usize)> {
        Some((self.reflection_in_use()?, self.lights.used.len()))
    }

    /// Eyes behind the first receiver in a view, in its space, and places that see nothing in that of the others; nothing of a plan
    /// without a reflection.
    pub(super) fn mirrored_eyes(&self, plan: &Plan, view: &View) -> Option<Vec<Vec4>> {
        let reflection = plan.reflection.as_ref()?;
        let layout = self.layout();
        let eye = view.camera_in(&layout.world_from_anchor());
        let foot = layout.toy_in_anchor.with_y(0.0);
        let eyes = reflection.mirrored_eyes(eye, foot);
        let mut points: Vec<Vec4> = eyes.into_iter().map(|eye| eye.as_vec4()).collect();
        points.resize(points.len() * self.receivers.len().max(1), NOWHERE);
        Some(points)
    }
}
