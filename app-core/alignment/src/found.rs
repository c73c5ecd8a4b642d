//! What alignment finds of a frame.

use std::sync::Arc;

use glam::DMat4;

use super::report::AlignmentReport;
use super::warning::AlignmentWarning;
use app_scene::frame::FrameInput;
use app_scene::reflection::Reflection;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::sharpness::Sharpness;
use app_scene::things::Things;

/// Where the toy and the lights of a frame are, by its picture.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Alignment {
    /// The camera: as given, where it was not corrected.
    pub camera: Camera,
    /// Transform of the real toy, from object space to world: as given, where it was not corrected.
    pub world_from_object: DMat4,
    /// The lights; none where those that were given stay.
    pub lights: Option<Arc<[Light]>>,
    /// The scene that the core is to be given before this frame is shown: its plates' cameras were corrected, its plates are in another
    /// light than before, its toy was adapted, or its receivers were laid under the toy. None if the core keeps the scene of the frame before, which for the
    /// first frame is the one that the [`Aligner`](crate::Aligner) was made with.
    pub scene: Option<Arc<Scene>>,
    /// Things that stand in the picture beside the toy; none where nothing tells of any.
    pub things: Option<Things>,
    /// How soft the picture is.
    pub sharpness: Sharpness,
    /// How the receiver that the toy stands on reflects; none where nothing tells that it does.
    pub reflection: Option<Reflection>,
    /// What was found.
    pub report: AlignmentReport,
    /// What could not be aligned.
    pub warnings: Vec<AlignmentWarning>,
}

impl Alignment {
    /// An input as given, of which nothing was found.
    #[must_use]
    pub fn new(input: &FrameInput) -> Self {
        Self {
            camera: input.camera,
            world_from_object: input.world_from_object,
            lights: None,
            scene: None,
            things: input.things.clone(),
            sharpness: input.sharpness,
            reflection: input.reflection,
            report: AlignmentReport::default(),
            warnings: Vec::new(),
        }
    }

    /// The input that it was found for, corrected.
    #[must_use]
    pub fn applied_to(&self, input: &FrameInput) -> FrameInput {
        input
            .clone()
            .with_camera(self.camera)
            .with_world_from_object(self.world_from_object)
            .with_lights(self.lights.clone().or_else(|| input.lights.clone()))
            .with_things(self.things.clone())
            .with_sharpness(self.sharpness)
            .with_reflection(self.reflection)
    }
}
