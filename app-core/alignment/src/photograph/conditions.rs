//! The conditions of a photograph: its softness, and the other things in it.

use glam::DMat4;

use super::Photograph;
use crate::{pose, softness, things};
use app_scene::frame::FrameInput;
use app_scene::scene::{Camera, Light, Scene};
use app_scene::sharpness::{Sharpness, Spread};
use app_scene::things::Things;
use app_scene::toy::ToyError;

impl Photograph {
    /// With the plate blurred by a spread, in pixels of the picture.
    pub(crate) fn with_plate_as_soft(self, spread: Spread) -> Self {
        let picture_px = self.pyramid.picture_px();
        self.with_plate_spread(spread.mean_px() / picture_px)
    }

    /// With unknown pixels at things and at wrong parts of the plate.
    pub(crate) fn clear_of(&self, things: &Things) -> Self {
        Self {
            pyramid: self.pyramid.clear_of(things.marks()),
            receivers: self.receivers.clone(),
            camera_from_world: self.camera_from_world,
        }
    }

    /// Other things beside the toy in its place, under given lights; `None` if they cannot be
    /// detected.
    pub(crate) fn things(
        &self,
        scene: &Scene,
        input: &FrameInput,
        lights: &[Light],
    ) -> Result<Option<Things>, ToyError> {
        let shape = self.shape(scene, &input.world_from_object)?;
        let paint = pose::Paint::new(scene, &self.camera_from_object(&input.world_from_object))?;
        let found = things::find(&things::Sight {
            shape: &shape,
            paint: &paint,
            receivers: &self.receivers,
            pyramid: &self.pyramid,
            lights,
            world_from_camera: &input.camera.world_from_camera,
        });
        // Camera of the largest level, which may be smaller than the picture.
        let camera = Camera {
            intrinsics: input.camera.intrinsics.scaled(self.pyramid.picture_px().recip()),
            ..input.camera
        };
        Ok(found.and_then(|(size_px, marks)| Things::new(size_px.as_uvec2(), marks, camera)))
    }

    /// The same for given camera and pose.
    pub(crate) fn sharpness_as_given(
        &self,
        scene: &Scene,
        world_from_object: &DMat4,
    ) -> Result<Sharpness, ToyError> {
        let start = self.start(scene, *world_from_object)?;
        let outline_px = pose::spread_px(start.subject(), &self.pyramid);
        let outline_px = outline_px.map(|px| px * self.pyramid.picture_px());
        self.sharpness(scene, world_from_object, outline_px)
    }

    /// The softness around a toy in its place, whose outline has the given blur in pixels; `None`
    /// for an outline that was not measured.
    pub(crate) fn sharpness(
        &self,
        scene: &Scene,
        world_from_object: &DMat4,
        outline_px: Option<f64>,
    ) -> Result<Sharpness, ToyError> {
        let shape = self.shape(scene, world_from_object)?;
        let (level, picture_px) = (self.pyramid.level(0), self.pyramid.picture_px());
        let outline_px = outline_px.map(|px| px / picture_px);
        let in_level = softness::sharpness(level, &pose::covered(&shape, level), outline_px);
        let in_picture = |spread: Spread| spread.times(picture_px * picture_px);
        Ok(Sharpness {
            plate_spread: in_picture(in_level.plate_spread),
            outline_spread: in_picture(in_level.outline_spread),
        })
    }
}
