//! Common parts of both methods' plans: facts of a scene, how much changed, and which work is skipped. Pure data, made
//! without a device.
//!
//! Two paths: the capture path learns from the real toy and its real shadow, once; the frame path makes each picture.

use serde::Serialize;

use crate::geometry::rect::PixelRect;
use app_scene::gloss::Gloss;
use app_scene::reflection::Reflection;
use app_scene::sharpness::Sharpness;

/// Facts of a scene that decide its plan.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFacts {
    /// Rectangle that toy and shadows can reach.
    pub region: PixelRect,
    /// Pixels of the image that can show the physical toy; none where it is out of the picture.
    pub physical_toy: Option<PixelRect>,
    /// Pixels of the image that targets of the toy are to hold, in whatever pose it is shown; none where it is out of the
    /// picture.
    pub toy_box: Option<PixelRect>,
    /// The same of maps of the physical toy.
    pub physical_box: Option<PixelRect>,
    /// What a pixel is across at the nearest part of the toy, in units of its file; 0 where the camera is within.
    pub pixel_in_object: f64,
    /// Width in pixels of the widest penumbra of each light whose shadows are moved.
    pub penumbrae_px: Vec<f64>,
    /// Receivers that shadows are moved on, one to four.
    pub n_receivers: u32,
    /// One plate shows all of the region, or several together.
    pub is_plate_complete: bool,
    /// Whether a plate was brought to the exposure of another.
    pub are_plates_scaled: bool,
    /// Whether things stand in the picture beside the toy, or a part of the plate is wrong.
    pub has_things: bool,
    /// How soft the picture is, as far as that is seen.
    pub sharpness: Sharpness,
    /// Whether this picture, or one before it, is softer than what is laid into it.
    pub is_softened: bool,
    /// How glossy the toy is.
    pub gloss: Gloss,
    /// Angular radius of each light whose shadows are moved, seen from the toy.
    pub angular_radii_rad: Vec<f64>,
    /// How the receiver that the toy stands on reflects; none where it is matt.
    pub reflection: Option<Reflection>,
}

/// Factor up to which a penumbra's width may change before it counts as another.
const STEADY: f64 = 1.25;

impl SceneFacts {
    /// With the known widths of penumbrae in place of those that are nearly the same, so that lights keep their points while a
    /// camera sways.
    #[must_use]
    pub fn steadied(mut self, known_px: &[f64]) -> Self {
        for (width_px, known_px) in self.penumbrae_px.iter_mut().zip(known_px) {
            if (known_px / STEADY..known_px * STEADY).contains(width_px) {
                *width_px = *known_px;
            }
        }
        self
    }
}

/// Work that a frame or a scene does not need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SkippedWork {
    /// The work that is skipped.
    pub what: &'static str,
    /// The reason in words.
    pub reason: &'static str,
}

/// What changed since the frame before; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// Only the pose that is shown.
    Pose,
    /// The camera's picture.
    Picture,
    /// The camera's pose, or the work region.
    View,
    /// The scene: no scene state is reused.
    Scene,
}

impl Change {
    /// The name in reports and profiles.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose",
            Self::Picture => "picture",
            Self::View => "view",
            Self::Scene => "scene",
        }
    }

    /// Every change, the least first.
    pub const ALL: [Self; 4] = [Self::Pose, Self::Picture, Self::View, Self::Scene];
}

/// What changed since the previous frame; selects the passes to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameDelta {
    pub(crate) change: Change,
    /// Whether another pose is shown than in the frame before.
    pub(crate) is_pose_new: bool,
    /// Whether the picture is as soft as the one before.
    pub(crate) keeps_sharpness: bool,
}

impl FrameDelta {
    /// Whether what is drawn of the shown pose alone, such as its shadows, can stay.
    pub(crate) fn keeps_pose(self) -> bool {
        !self.is_pose_new && self.keeps_physical()
    }

    /// Whether what is drawn of the physical pose can stay.
    pub(crate) fn keeps_physical(self) -> bool {
        self.keeps_sharpness && self.change < Change::View
    }

    /// Whether the picture can stay, too.
    pub(crate) fn keeps_picture(self) -> bool {
        self.keeps_pose() && self.change < Change::Picture
    }
}
