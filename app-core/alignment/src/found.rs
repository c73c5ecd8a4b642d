//! The result of aligning a frame.

use std::sync::Arc;

use glam::DMat4;

use super::report::AlignmentReport;
use super::warning::AlignmentWarning;
use app_scene::frame::FrameInput;
use app_scene::gloss::Gloss;
use app_scene::grain::Grain;
use app_scene::reflection::Reflection;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::sharpness::Sharpness;
use app_scene::things::Things;

/// Camera, toy and lights of a frame, estimated from its picture.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Alignment {
    /// The camera: as given if it was not corrected.
    pub camera: Camera,
    /// Transform of the real toy, from object space to world: as given if it was not corrected.
    pub world_from_object: DMat4,
    /// The lights; `None` if the given ones stay.
    pub lights: Option<Arc<[Light]>>,
    /// The scene to set before this frame is shown, if it changed: its plates' cameras were corrected, its plates were
    /// relit, its toy was adapted, or its receivers were fitted under the toy. `None` if the previous frame's scene
    /// stays, which for the first frame is the one that the [`Aligner`](crate::Aligner) was made with.
    pub scene: Option<Arc<Scene>>,
    /// Other things in the picture; `None` if they cannot be detected.
    pub things: Option<Things>,
    /// The softness of the picture.
    pub sharpness: Sharpness,
    /// The noise of the picture and of its plate, as seen by its camera; `None` if the picture
    /// is clean, or if its grain is unknown.
    pub grain: Option<Grain>,
    /// The reflection of the receiver below the toy; `None` if it is matt, as far as the picture shows.
    pub reflection: Option<Reflection>,
    /// Gloss of the toy.
    pub gloss: Gloss,
    /// The report.
    pub report: AlignmentReport,
    /// Failures of parts of the alignment.
    pub warnings: Vec<AlignmentWarning>,
}

impl Alignment {
    /// An input as given, without any estimate.
    #[must_use]
    pub fn new(input: &FrameInput) -> Self {
        Self {
            camera: input.camera,
            world_from_object: input.world_from_object,
            lights: None,
            scene: None,
            things: input.things.clone(),
            sharpness: input.sharpness,
            grain: input.grain,
            reflection: input.reflection,
            gloss: input.gloss,
            report: AlignmentReport::default(),
            warnings: Vec::new(),
        }
    }

    /// The input, corrected.
    #[must_use]
    pub fn applied_to(&self, input: &FrameInput) -> FrameInput {
        input
            .clone()
            .with_camera(self.camera)
            .with_world_from_object(self.world_from_object)
            .with_lights(self.lights.clone().or_else(|| input.lights.clone()))
            .with_things(self.things.clone())
            .with_sharpness(self.sharpness)
            .with_grain(self.grain)
            .with_reflection(self.reflection)
            .with_gloss(self.gloss)
    }
}
