//! Common parts of both methods' plans: facts of a scene, how much changed, and skipped work. Pure
//! data, made without a device.
//!
//! There are two paths: the capture path learns from the real toy and its real shadow, once; the
//! frame path makes each picture.

use serde::Serialize;

use crate::geometry::rect::PixelRect;
use app_scene::gloss::Gloss;
use app_scene::reflection::Reflection;
use app_scene::sharpness::Sharpness;
use app_scene::things::Front;

/// Facts of a scene that determine its plan.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFacts {
    /// Rectangle that toy and shadows can reach.
    pub region: PixelRect,
    /// Pixels of the image that can show the physical toy; `None` if it is out of the picture.
    pub physical_toy: Option<PixelRect>,
    /// Pixels of the image that the toy's targets must cover, in every shown pose; `None` if it is
    /// out of the picture.
    pub toy_box: Option<PixelRect>,
    /// The same for maps of the physical toy.
    pub physical_box: Option<PixelRect>,
    /// Size of a pixel at the nearest part of the toy, in units of its file; 0 if the camera is
    /// inside.
    pub pixel_in_object: f64,
    /// Width in pixels of the widest penumbra of each retargeted light.
    pub penumbrae_px: Vec<f64>,
    /// Number of receivers on which shadows are retargeted, one to four.
    pub n_receivers: u32,
    /// Whether one plate, or several together, show the whole region.
    pub is_plate_complete: bool,
    /// Whether a plate was converted to the exposure of another.
    pub are_plates_scaled: bool,
    /// Whether there are things beside the toy in the picture, or wrong parts of the plate.
    pub has_things: bool,
    /// Whether shadows fall on these.
    pub has_raised_things: bool,
    /// The fronts of things before the toy in anchor space, as `Things::fronts`, without those that camera and toy
    /// are not both before.
    pub things_fronts: Vec<Front>,
    /// Estimated sharpness of the picture.
    pub sharpness: Sharpness,
    /// Whether this picture or an earlier one is softer than the content that is drawn into it.
    pub is_softened: bool,
    /// Gloss of the toy.
    pub gloss: Gloss,
    /// Angular radius of each retargeted light, seen from the toy.
    pub angular_radii_rad: Vec<f64>,
    /// Reflection of the receiver below the toy; `None` if it is matt.
    pub reflection: Option<Reflection>,
}

/// Factor up to which a penumbra's width may change before it counts as a new one.
const STEADY: f64 = 1.25;

impl SceneFacts {
    /// Keeps the known widths of penumbrae that are nearly the same, so that lights keep their
    /// points while a camera sways.
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

/// The kind of change since the previous frame; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// Only the shown pose.
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

    /// Every change, from the smallest to the largest.
    pub const ALL: [Self; 4] = [Self::Pose, Self::Picture, Self::View, Self::Scene];
}

/// Changes since the previous frame, which select the passes to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameDelta {
    pub(crate) change: Change,
    /// Whether the shown pose differs from that of the previous frame.
    pub(crate) is_pose_new: bool,
    /// Whether the picture is as sharp as the previous one.
    pub(crate) keeps_sharpness: bool,
}

impl FrameDelta {
    /// Whether results that depend on the shown pose alone, such as its shadows, can be reused.
    pub(crate) fn keeps_pose(self) -> bool {
        !self.is_pose_new && self.keeps_physical()
    }

    /// Whether results that depend on the physical pose can be reused.
    pub(crate) fn keeps_physical(self) -> bool {
        self.keeps_sharpness && self.change < Change::View
    }

    /// Whether the picture can be reused, too.
    pub(crate) fn keeps_picture(self) -> bool {
        self.keeps_pose() && self.change < Change::Picture
    }
}
