//! The content to draw below the interface.

use std::sync::Arc;

use glam::DVec2;

use app_scene::camera_frame::{CameraFrame, Display};
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

use super::App;
use super::search::Placing;
use super::step::Step;
use app_alignment::Silhouette;

/// The content to draw below the interface.
#[derive(Debug)]
pub enum Show<'a> {
    /// There is no camera frame yet.
    Nothing,
    /// The camera's picture, unchanged.
    Camera(&'a CameraFrame),
    /// The toy in motion, with the effect at its current strength.
    Toy {
        /// The scene: another one is another allocation.
        scene: &'a Arc<Scene>,
        /// The input of [`Core::frame`](app_pipeline::Core::frame).
        input: Box<FrameInput>,
        /// Placement of the picture on the screen.
        display: Display,
    },
}

impl App {
    /// The content to draw below the interface.
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

    /// Silhouette of the ghost in the camera's picture; `None` while its pose is unknown.
    #[must_use]
    pub fn ghost(&self) -> Option<Silhouette> {
        let (ghost, camera) = (self.ghost.as_ref()?, self.camera.as_ref()?);
        let latest = self.latest.as_ref().filter(|_| self.shows_ghost())?;
        let size_px = latest.image.size_px();
        self.ghost_shape
            .silhouette(&ghost.world_from_object(), (camera, size_px))
    }

    /// The corners of the ghost's ring and its knob, in pixels of the camera's picture; `None` if
    /// nobody turns it.
    #[must_use]
    pub fn ring_px(&self) -> Option<(Vec<DVec2>, DVec2)> {
        let is_turned = self.step == Step::PlaceToy && self.placing() == Placing::ByHand;
        let ghost = self.ghost.as_ref().filter(|_| is_turned)?;
        ghost.ring_px(self.camera.as_ref()?)
    }

    /// The size of the camera's picture and its placement on the screen; `None` before the first
    /// frame.
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
