//! Scores of directions for a light, for drawing.

use glam::DVec3;

use super::error::{AlignError, check};
use super::lights::scores;
use super::photograph::Photograph;
use super::receivers::up;
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// The first step of the search for unlisted lights: point lights all over the hemisphere above the
/// receiver nearest to the toy.
#[derive(Clone, Debug)]
pub struct LightSearch {
    /// Normal of that receiver.
    pub up_in_world: DVec3,
    /// Unit vectors in the world, evenly spread, and the fraction of the loss with ambient light
    /// alone that a light there explains: 0 to 1.
    pub explained: Vec<(DVec3, f64)>,
}

impl LightSearch {
    /// The scores for the toy in the input's place; `None` if too little of the receivers is
    /// visible.
    ///
    /// # Errors
    /// As [`Aligner::align`](super::Aligner::align).
    pub fn of(scene: &Scene, input: &FrameInput) -> Result<Option<Self>, AlignError> {
        check(scene, input)?;
        let photograph = Photograph::new(scene, input);
        let shape = photograph.shape(scene, &input.world_from_object)?;
        let view = photograph.seen(&shape);
        let world_from_camera = &input.camera.world_from_camera;
        let in_world = |direction| world_from_camera.transform_vector3(direction).normalize();
        let scores = scores(&shape, view.receivers, view.pyramid);
        Ok(scores.map(|scores| Self {
            up_in_world: in_world(up(view.receivers)),
            explained: scores
                .into_iter()
                .map(|(direction, explained)| (in_world(direction), explained))
                .collect(),
        }))
    }
}
