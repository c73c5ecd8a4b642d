//! A view: one picture with its camera, and the pose of the toy in it.

use std::sync::Arc;

use glam::DMat4;

use super::lights::FoundReflection;
use super::photograph::Photograph;
use super::picture::Mask;
use super::report::{CameraAlignment, PoseAlignment};
use super::rigid_motion::Matrix6;
use super::softness::is_motion;
use app_scene::camera_frame::CameraImage;
use app_scene::frame::FrameInput;
use app_scene::grain::Grain;
use app_scene::scene::{Camera, Scene};
use app_scene::sharpness::{Sharpness, Spread};
use app_scene::things::Things;
use app_scene::toy::ToyError;

/// A view with its photograph.
pub(super) struct Seen {
    pub(super) view: AlignedView,
    pub(super) photograph: Photograph,
    /// The frame's input, with the estimated camera and pose.
    pub(super) input: FrameInput,
}

/// Camera and pose in the latest view.
#[derive(Clone, Debug)]
pub(super) struct AlignedView {
    pub(super) image: CameraImage,
    /// The pixels of people in it; `None` if there are none.
    pub(super) people: Option<Arc<Mask>>,
    pub(super) given_camera: Camera,
    pub(super) given: DMat4,
    pub(super) camera: Camera,
    pub(super) camera_report: Option<CameraAlignment>,
    pub(super) world_from_object: DMat4,
    /// Pixels of the picture per pixel of the level in which the pose was found.
    pub(super) picture_px: f64,
    /// The blur of the plate beside which lights and things are estimated.
    pub(super) plate_spread: Spread,
    /// Covariance of the pose by its outline; `None` if it is not an estimate.
    pub(super) covariance: Option<Matrix6>,
    pub(super) report: Option<PoseAlignment>,
    pub(super) sharpness: Sharpness,
    pub(super) grain: Option<Grain>,
}

impl Seen {
    /// A view that was aligned before.
    pub(super) fn again(scene: &Scene, view: AlignedView, input: &FrameInput) -> Self {
        let input = input
            .clone()
            .with_camera(view.camera)
            .with_world_from_object(view.world_from_object);
        Self {
            photograph: Photograph::without(scene, &input, view.people.as_deref())
                .with_plate_as_soft(view.plate_spread),
            view,
            input,
        }
    }

    /// The same view, as if the receiver that the toy stands on were matt.
    pub(super) fn freed_of(&self, scene: &Scene, found: &FoundReflection) -> Result<Self, ToyError> {
        Ok(Self {
            view: self.view.clone(),
            photograph: self.photograph.freed_of(scene, &self.input, found)?,
            input: self.input.clone(),
        })
    }

    /// The same view, with unknown pixels at things and at wrong parts of the plate.
    pub(super) fn clear_of(&self, things: &Things) -> Self {
        self.with_photograph(self.photograph.clear_of(things))
    }

    /// With a photograph in which other pixels are unknown.
    pub(super) fn with_photograph(&self, photograph: Photograph) -> Self {
        Self {
            view: self.view.clone(),
            photograph,
            input: self.input.clone(),
        }
    }
}

impl AlignedView {
    pub(super) fn is_of(&self, input: &FrameInput) -> bool {
        self.image.is(&input.image)
            && self.given_camera == input.camera
            && self.given == input.world_from_object
    }

    /// Whether a motion blurs the picture, so that a round blur displaces pieces of the outline. The texture beside
    /// the toy tells: a displaced outline looks as if it moved, too.
    pub(super) fn is_moving(&self) -> bool {
        is_motion(&self.sharpness.plate_spread)
    }

    /// Whether the outline fits the picture's, within some pixels of the largest level.
    pub(super) fn is_trusted(&self, most_px: f64) -> bool {
        self.report
            .is_some_and(|pose| pose.shown_px() <= most_px * self.picture_px)
    }
}
