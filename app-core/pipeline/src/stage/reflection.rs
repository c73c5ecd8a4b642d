//! The toy's image in a glossy receiver: the reflection in use, and the eyes behind the receiver
//! from which the image is drawn.

use glam::Vec4;

use super::Stage;
use crate::frame::warning::Warning;
use crate::geometry::view::View;
use crate::model::plan::Plan;
use crate::preset::Settings;
use app_scene::frame::FrameInput;
use app_scene::reflection::Reflection;
use app_scene::scene::MAX_LIGHTS;

/// Roughness below which a receiver shows more of the toy than its mean colour.
const LEAST_ROUGHNESS: f64 = 0.05;

/// A homogeneous light below a receiver: it casts no shadow there.
const NOWHERE: Vec4 = Vec4::NEG_Y;

impl Stage {
    /// Adopts the frame's reflection of the first receiver. Returns whether it changed.
    pub(super) fn take_reflection(&mut self, input: &FrameInput) -> bool {
        let given = match self.settings {
            Settings::Model(_) => input.reflection,
            Settings::Baseline(_) => None,
        };
        std::mem::replace(&mut self.reflection, given) != given
    }

    /// Reflection of the first receiver, if the lights leave a channel of the visibilities.
    pub(super) fn reflection_in_use(&self) -> Option<&Reflection> {
        let has_channel = self.lights.used.len() < MAX_LIGHTS;
        self.reflection.as_ref().filter(|_| has_channel)
    }

    /// Surfaces of toy and table that reflect more than is modelled.
    pub(super) fn surface_warnings(&self) -> impl Iterator<Item = Warning> {
        self.gloss_warning().into_iter().chain(self.reflection_warning())
    }

    /// The warning that the receiver is too smooth for one colour of the toy.
    fn reflection_warning(&self) -> Option<Warning> {
        let roughness = self.reflection_in_use()?.roughness;
        (roughness < LEAST_ROUGHNESS).then_some(Warning::MirrorLike { roughness })
    }

    /// The reflection in use and its channel.
    pub(super) fn reflection_channel(&self) -> Option<(&Reflection, usize)> {
        Some((self.reflection_in_use()?, self.lights.used.len()))
    }

    /// Eyes behind the first receiver in a view, in its space, and blind places in the space of the
    /// others; `None` if the plan has no reflection.
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
