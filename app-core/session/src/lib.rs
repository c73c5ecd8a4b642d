//! Sessions: a scene and its camera frames, in any storage.
//!
//! A recording, a live camera and a folder of pictures have the same interface: a [`Scene`] that is
//! available at once and frames that are fetched one by one. Bytes come through [`Files`], so this
//! crate opens no file itself, except in the `Folder` of the feature `fs`.
//!
#![doc = include_str!("../../doc/session.md")]
#![forbid(unsafe_code)]

mod capture;
mod error;
mod files;
#[cfg(feature = "fs")]
mod folder;
mod picture;
pub mod recording;
pub mod tags;

use std::ops::Range;
use std::sync::Arc;

use glam::DMat4;
use thiserror::Error;

use app_scene::depth::Depth;
use app_scene::frame::FrameInput;
use app_scene::lens::Lens;
use app_scene::people::People;
use app_scene::scene::{Camera, Image, LightEstimate, Pose, Scene};
use app_scene::toy::ToyWarning;
use app_scene::words::Number;

pub use app_scene::scene::FieldError;
#[cfg(feature = "schema")]
pub use capture::schema;
pub use capture::{Capture, ScenePaths, index_bytes, record, toy_bytes, toy_neighbours};
pub use error::{PictureError, SessionError, SessionErrorKind};
pub use files::{FileError, Files, INDEX_FILE, MAX_INDEX_BYTES, PathError, check_path};
#[cfg(feature = "fs")]
pub use folder::{Folder, FolderError};

/// A scene with frames of it.
pub trait Session {
    /// The scene, which stays the same for all frames.
    fn scene(&self) -> &Scene;

    /// Warnings about the session as a whole.
    fn warnings(&self) -> &[SessionWarning];

    /// Number of frames; at least one.
    fn n_frames(&self) -> usize;

    /// Fetches and decodes the frame `index`, counted from 0.
    ///
    /// # Errors
    /// When there is no such frame, or its picture cannot be read.
    fn frame(&self, index: usize) -> Result<SessionFrame, SessionError>;

    /// Checks the picture files of `frames` without decoding them: whether each exists, is of a
    /// supported format and has the session's size. Call it before long work.
    ///
    /// # Errors
    /// When there are no such frames, or a picture of one cannot be read.
    fn check_pictures(&self, _frames: Range<usize>) -> Result<(), SessionError> {
        Ok(())
    }

    /// The photograph of the frame `index` as its camera took it, distortion included:
    /// [`SessionFrame::image`] if the session has no lens.
    ///
    /// # Errors
    /// As [`Session::frame`].
    fn photograph(&self, index: usize) -> Result<Arc<Image>, SessionError> {
        Ok(self.frame(index)?.image)
    }

    /// The lens of [`Session::photograph`] of the frame `index`, which is removed from
    /// [`SessionFrame::image`]; `None` if the session has none.
    ///
    /// # Errors
    /// When there is no such frame.
    fn lens(&self, _index: usize) -> Result<Option<Lens>, SessionError> {
        Ok(None)
    }
}

/// One camera frame and the pose to show in it.
#[derive(Clone, Debug)]
pub struct SessionFrame {
    /// Time of the frame, from an origin of the session's own.
    pub time_secs: f64,
    /// The camera's picture of the real toy, without distortion. Frames that repeat a picture share
    /// it.
    pub image: Arc<Image>,
    /// The camera that took it.
    pub camera: Camera,
    /// Transform of the real toy, from object space to world.
    pub world_from_object: DMat4,
    /// Exposure of the picture, relative to that of the session's other frames; 1 if unknown.
    pub exposure: f64,
    /// The platform's light estimate, if it is recorded.
    pub light_estimate: Option<LightEstimate>,
    /// Depths of the picture, if they are recorded.
    pub depth: Option<Depth>,
    /// People in the picture, if a mask of them is recorded.
    pub people: Option<People>,
    /// The pose to show.
    pub shown_pose: Pose,
    /// The place to show the toy, if it differs from the real toy's.
    pub world_from_shown: Option<DMat4>,
    /// Warnings about this frame.
    pub warnings: Vec<SessionWarning>,
}

impl From<&SessionFrame> for FrameInput {
    fn from(frame: &SessionFrame) -> Self {
        Self::new(Arc::clone(&frame.image), frame.camera, frame.world_from_object)
            .with_exposure(frame.exposure)
            .with_light_estimate(frame.light_estimate)
            .with_depth(frame.depth.clone())
            .with_people(frame.people.clone())
            .with_shown_pose(frame.shown_pose.clone())
            .with_world_from_shown(frame.world_from_shown)
    }
}

/// The photographs that the camera would have taken of the really moved toy, through its lens.
///
/// Only for scoring. It is not part of [`Session`], so code that makes pictures from a session
/// cannot reach them.
pub trait GroundTruth {
    /// Fetches the truth of the frame `index`, or `None` if the session has none.
    ///
    /// # Errors
    /// When there is no such frame, or its pictures cannot be read.
    fn truth(&self, index: usize) -> Result<Option<Truth>, SessionError>;
}

/// The truth of one frame, both pictures of the session's size.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The photograph of the moved toy.
    pub image: Image,
    /// Labels of each pixel, as plain numbers in all four channels.
    ///
    /// R is 255 on the moved toy, G on the real toy. B is 255 times one minus the smallest
    /// visibility over all lights with the moved toy, A the same with the real one.
    pub mask: Image,
}

/// A value that was corrected or ignored while reading.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SessionWarning {
    /// A time beyond the end of its clip; the clip's last moment is shown.
    #[error(
        "{file} ({field}): {} s is beyond the end of the clip, {} s is used",
        Number(*asked_secs),
        Number(*used_secs)
    )]
    TimeClamped {
        /// File with the time.
        file: String,
        /// Path of the time within the file.
        field: String,
        /// The time as written.
        asked_secs: f64,
        /// The time that is used instead.
        used_secs: f64,
    },
    /// A picture with an orientation tag. It is read as stored, since cameras' intrinsics refer to
    /// that.
    #[error(
        "{file} ({field}): its EXIF orientation is {orientation}, which is not applied: if the picture lies on its side or is mirrored, turn its pixels; otherwise remove the tag"
    )]
    Turned {
        /// File of the picture.
        file: String,
        /// Path of the field that names it.
        field: String,
        /// 2 to 8, as EXIF numbers them.
        orientation: u8,
    },
    /// A feature of the toy's file that is not supported.
    #[error("{file}: {warning}")]
    Toy {
        /// File of the toy.
        file: String,
        /// The feature.
        warning: ToyWarning,
    },
}
