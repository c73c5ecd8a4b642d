//! What a platform's AR session delivers with each camera picture.

use std::sync::Arc;

use glam::{DMat4, DVec2};

use super::arrival::Stamp;
use super::display::Display;
use super::image::CameraImage;
use crate::scene::{Camera, Intrinsics, LightEstimate};

/// How well the platform follows the camera, and what a person can do about it.
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
    /// After an interruption the place is looked for.
    Relocalising,
}

/// How a picture was exposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Seconds.
    pub duration_s: f64,
    /// ISO speed.
    pub iso: f64,
}

impl Exposure {
    /// Duration times sensitivity, in seconds at ISO 100; none where that is no positive number.
    #[must_use]
    pub fn amount(&self) -> Option<f64> {
        let amount = self.duration_s * self.iso / 100.0;
        (amount.is_finite() && amount > 0.0).then_some(amount)
    }
}

/// A level plane that the platform found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundPlane {
    /// Its name with the platform, the same from frame to frame.
    pub id: u64,
    /// Rigid: local y = 0, its normal along local +Y.
    pub world_from_plane: DMat4,
    /// It reaches `|x| <= half_extent_m.x`, `|z| <= half_extent_m.y` as far as it was seen.
    pub half_extent_m: DVec2,
}

/// A place in the world that the platform was asked to hold, and corrects as it learns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The number that it was asked for by.
    pub id: u64,
    /// Rigid; where it is now.
    pub world_from_anchor: DMat4,
}

impl Anchor {
    /// Number of the anchor that nobody asked for: of the toy itself, as the platform recognises it by a scan. Its axes are the scan's.
    pub const OF_TOY: u64 = u64::MAX;
}

/// A camera picture and all that the platform says of it.
///
/// Pixels count from the top left of the sensor's picture, which is never turned; the world is in metres, +Y up.
#[derive(Clone, Debug)]
pub struct CameraFrame {
    /// Which frame it is.
    pub stamp: Stamp,
    /// Milliseconds from the picture until it was delivered; none where no clock tells, see [`Stamp::age_ms`].
    pub age_ms: Option<f64>,
    /// The picture.
    pub image: CameraImage,
    /// Of this very picture: stabilised lenses move.
    pub intrinsics: Intrinsics,
    /// None where the platform does not say.
    pub exposure: Option<Exposure>,
    /// How well the camera is followed.
    pub tracking: Tracking,
    /// Where the camera was; none where the platform has no pose.
    pub world_from_camera: Option<DMat4>,
    /// Level planes known by now.
    pub planes: Arc<[FoundPlane]>,
    /// Anchors that are followed by now.
    pub anchors: Arc<[Anchor]>,
    /// Where the printed card is, from [card space](crate::card), rigid; none where it is not seen in this picture, or not looked for.
    pub world_from_card: Option<DMat4>,
    /// What the platform estimates of the light.
    pub light_estimate: Option<LightEstimate>,
    /// How the picture is to be shown.
    pub display: Display,
}

impl CameraFrame {
    /// The camera, where its pose can be trusted.
    #[must_use]
    pub fn camera(&self) -> Option<Camera> {
        let world_from_camera = self.world_from_camera.filter(|pose| pose.is_finite())?;
        (self.tracking == Tracking::Normal).then_some(Camera {
            intrinsics: self.intrinsics,
            world_from_camera,
        })
    }
}
