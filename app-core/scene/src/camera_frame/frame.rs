//! The data that a platform's AR session delivers with each camera picture.

use std::sync::Arc;

use glam::{DMat4, DVec2, UVec2};

use super::arrival::Stamp;
use super::display::Display;
use super::image::CameraImage;
use crate::depth::Depth;
use crate::people::People;
use crate::scene::check;
use crate::scene::{Camera, Intrinsics, LightEstimate};

/// Quality of the platform's camera tracking, with the reason if a person can help.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tracking {
    /// It has no pose.
    #[default]
    Starting,
    /// The pose can be trusted.
    Normal,
    /// The camera moves too fast.
    TooFast,
    /// Too little texture is in view.
    TooPlain,
    /// It is too dark.
    TooDark,
    /// It searches for the place after an interruption.
    Relocalising,
}

/// The exposure of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Seconds.
    pub duration_s: f64,
    /// ISO speed.
    pub iso: f64,
}

impl Exposure {
    /// Duration times sensitivity, in seconds at ISO 100; `None` if that is no positive number.
    #[must_use]
    pub fn amount(&self) -> Option<f64> {
        let amount = self.duration_s * self.iso / 100.0;
        (amount.is_finite() && amount > 0.0).then_some(amount)
    }
}

/// A level plane that the platform found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundPlane {
    /// The platform's identifier, the same in all frames.
    pub id: u64,
    /// Rigid: local y = 0, its normal along local +Y.
    pub world_from_plane: DMat4,
    /// Seen extent: `|x| <= half_extent_m.x`, `|z| <= half_extent_m.y`.
    pub half_extent_m: DVec2,
}

/// A place in the world that the platform keeps and corrects at our request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The number of the request.
    pub id: u64,
    /// Current pose; rigid.
    pub world_from_anchor: DMat4,
}

impl Anchor {
    /// Number of the toy's own anchor, if the platform recognises the toy by a scan. Its axes are
    /// the scan's.
    pub const OF_TOY: u64 = u64::MAX;
}

/// A camera picture and the platform's data about it.
///
/// Pixels count from the top left of the sensor's picture, which is never turned; the world is in
/// metres, +Y up.
#[derive(Clone, Debug)]
pub struct CameraFrame {
    /// The time stamp.
    pub stamp: Stamp,
    /// Milliseconds from the picture until its delivery; `None` if no clock measures it, see
    /// [`Stamp::age_ms`].
    pub age_ms: Option<f64>,
    /// The picture.
    pub image: CameraImage,
    /// Intrinsics of this very picture: stabilised lenses move.
    pub intrinsics: Intrinsics,
    /// `None` if the platform does not report it.
    pub exposure: Option<Exposure>,
    /// Quality of the tracking.
    pub tracking: Tracking,
    /// Pose of the camera; `None` if the platform has none.
    pub world_from_camera: Option<DMat4>,
    /// Level planes found so far.
    pub planes: Arc<[FoundPlane]>,
    /// Anchors currently tracked.
    pub anchors: Arc<[Anchor]>,
    /// Pose of the printed card, from [card space](crate::card), rigid; `None` if it is not visible
    /// in this picture, or not searched for.
    pub world_from_card: Option<DMat4>,
    /// The platform's estimate of the light.
    pub light_estimate: Option<LightEstimate>,
    /// The people in the picture; `None` if the platform does not tell.
    pub people: Option<People>,
    /// Depths of the picture, if the platform measures them and was asked to.
    pub depth: Option<Depth>,
    /// Presentation of the picture.
    pub display: Display,
}

impl CameraFrame {
    /// The frame without depths or a mask that are too large, or not of the picture's shape.
    #[must_use]
    pub fn with_maps_of_its_shape(mut self) -> Self {
        let picture_px = self.image.size_px();
        let is_right = |size_px: UVec2| check::map_size(size_px.to_array(), picture_px).is_ok();
        self.depth = self.depth.filter(|depth| is_right(depth.size_px()));
        self.people = self.people.filter(|people| is_right(people.size_px()));
        self
    }

    /// The camera, if its pose can be trusted.
    #[must_use]
    pub fn camera(&self) -> Option<Camera> {
        let world_from_camera = self.world_from_camera.filter(|pose| pose.is_finite())?;
        (self.tracking == Tracking::Normal).then_some(Camera {
            intrinsics: self.intrinsics,
            world_from_camera,
        })
    }
}
