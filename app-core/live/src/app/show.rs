//! What is to be drawn.

use std::sync::Arc;

use glam::DVec2;

use app_scene::camera_frame::{CameraFrame, Display};
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

use super::App;
use super::step::Step;

/// What is to be drawn below the interface.
#[derive(Debug)]
pub enum Show<'a> {
    /// Nothing has come from the camera.
    Nothing,
    /// The camera's picture as it is.
    Camera(&'a CameraFrame),
    /// The toy in motion, as far as the effect is shown.
    Toy {
        /// The scene: another one is another allocation.
        scene: &'a Arc<Scene>,
        /// For [`Core::frame`](app_pipeline::Core::frame).
        input: Box<FrameInput>,
        /// How the picture lies on the screen.
        display: Display,
    },
}

impl App {
    /// What is to be drawn below the interface.
    #[must_use]
    pub fn show(&self) -> Show<'_> {
        let Some(latest) = &self.latest else {
            return Show::Nothing;
        };
        let effect = self.fade.effect();
        match (&self.place, self.input(effect)) {
            (Some(place), Some(input)) if self.step == Step::Play && effect > 0.0 => Show::Toy {
                scene: &place.scene,
                input: Box::new(place.corrected(input)),
                display: latest.display,
            },
            _ => Show::Camera(latest),
        }
    }

    /// The contour of the toy where a person puts it, as pairs of pixels of the camera's picture; empty in other steps.
    #[must_use]
    pub fn ghost_contour_px(&self) -> Vec<[DVec2; 2]> {
        let is_shown = matches!(self.step, Step::PlaceToy | Step::Align);
        match (&self.ghost, &self.camera) {
            (Some(ghost), Some(camera)) if is_shown => {
                self.ghost_shape.contour_px(&ghost.world_from_object(), camera)
            }
            _ => Vec::new(),
        }
    }

    /// The camera's picture: its size, and how it lies on the screen; none before the first.
    #[must_use]
    pub fn picture(&self) -> Option<([u32; 2], Display)> {
        let latest = self.latest.as_ref()?;
        Some((latest.image.size_px(), latest.display))
    }

    /// The latest camera frame.
    #[must_use]
    pub fn latest(&self) -> Option<&CameraFrame> {
        self.latest.as_deref()
    }
}
