//! Lights from a probe: a flat Fresnel lens or a mirror ball in the scene, in underexposed
//! pictures.
//!
//! Source: Casas et al. 2019, section 3, «Enhanced Shadow Retargeting with Light-Source Estimation
//! Using Flat Fresnel Lenses». A mirror of known shape and pose shows each light in one place, and
//! the law of reflection gives the light's direction. The pictures are so dark that little but
//! lights is bright in them.
//!
//! ```text
//! ProbeView ─► highlights ─► reading, or published ─► Sighting ─┐
//!                                        earlier views ─────────┴► Track ─► TrackedLight
//! ```
//!
//! # As published, and what differs here
//!
//! [`Form::Published`] is the paper's own: pixels whose channels are all above .9 (equation 2),
//! their middle (equation 3), the hemisphere's normal N there, and L = 2 (N · R) N − R with R = (0,
//! 0, 1) (equation 4). R has to be the direction to the viewer, who is thus taken to be far away on
//! the lens's axis. Reflection in a fixed N keeps angles, so the error of L is exactly the angle
//! between the axis and the true direction to the viewer. [`Form::Exact`] takes that direction for
//! each pixel instead; its facets may differ from the hemisphere's
//! ([`FacetSlope`](app_scene::scene::FacetSlope)), after the calibration of a real lens
//! ([`facet_at`]); its centres are weighted by light and solid angle; and regions that belong to no
//! light are rejected.
//!
//! Errata of the paper, as far as they matter here:
//! - Equation 1's r is the largest distance within the lens, that is the lens's radius, of which
//!   the hemisphere of equation 4 is made;
//!   the text feeds the same r to the soft shadow as the light's size. The caption of figure 10
//!   says «radius of the highly saturated
//!   region», which is taken here; r is the radius of the known lens.
//! - Equation 3 has |h| for the number of all bright pixels, but the text says that it is taken for
//!   each region.
//! - Beyond .71 of the radius the hemisphere sends a viewer on the axis below the horizon.
//!
//! A highlight is an initial guess. It gives the direction at the probe, so that the direction at
//! the toy of a near light is wrong, unless several views constrain its distance ([`Track`]); and
//! it is a few pixels large, so that its size hardly constrains the light's. Alignment corrects
//! both by the shadow.

mod ball;
mod error;
mod highlights;
mod lens;
mod look;
mod near_light;
mod published;
mod reading;
mod reflection;
mod surface;
mod track;
mod viewpoint;

use glam::{DVec2, DVec3};
use serde::{Serialize, Serializer};

use app_scene::scene::{ProbePicture, ProbeShape};

pub use error::ProbeError;
pub use look::{facet_at, look};
pub use track::{ProbeReport, Track, TrackedLight};

/// A picture of a probe: image, intrinsics, pose of the camera, pose and shape of the probe.
#[derive(Clone, Copy, Debug)]
pub struct ProbeView<'a> {
    /// The probe's shape.
    pub shape: &'a ProbeShape,
    /// The picture, its camera, and the probe's pose.
    pub picture: &'a ProbePicture,
}

/// The method that converts highlights to lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// With the true direction to the viewer, and rejection of regions that belong to no light.
    #[default]
    Exact,
    /// The paper's method: the viewer on the lens's axis, or for a ball on the axis through its
    /// centre; each bright region is a light.
    Published,
}

/// The lights in a picture of a probe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sighting {
    /// Lights, the strongest first.
    pub lights: Vec<SeenLight>,
    /// Rejected bright regions, in the order of their rows.
    pub rejected: Vec<Rejected>,
}

/// A light in one picture of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeenLight {
    /// Position of the reflection on the probe, in the world, metres.
    pub origin_in_world: DVec3,
    /// Unit vector from there.
    pub direction_in_world: DVec3,
    /// Standard deviation of the direction, in radians: that of a tenth of a pixel.
    pub deviation_rad: f64,
    /// Angular radius, in radians, as far as its highlight constrains it.
    pub angular_radius_rad: f64,
    /// Linear light times solid angle, in units of the picture's white; too small for clipped
    /// highlights.
    pub power: f64,
    /// Centre of the highlight, in pixels.
    pub at_px: DVec2,
}

/// A rejected bright region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rejected {
    /// Its centre, in pixels.
    pub at_px: DVec2,
    /// The reason.
    pub reason: Reason,
}

/// The reason why a region belongs to no light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// It is long, like the streaks from the back walls of facets; lights are round.
    Streak {
        /// Its length over its width, as angles in the mirror.
        elongation: f64,
    },
    /// It extends beyond the probe's border, so that its centre is unknown.
    AtRim,
    /// The reflected direction is below the lens.
    BelowLens,
    /// It is wider than a light whose shadow has a shape: the picture is not dark enough, or it
    /// shows a window.
    TooWide {
        /// Angular radius, in radians.
        angular_radius_rad: f64,
    },
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Streak { elongation } => {
                write!(f, "it is a streak, {elongation:.1} times as long as wide")
            }
            Self::AtRim => f.write_str("it extends beyond the probe's border"),
            Self::BelowLens => f.write_str("its reflected direction is below the lens"),
            Self::TooWide { angular_radius_rad } => write!(
                f,
                "it is {:.0} degrees wide: the picture is not dark enough",
                2.0 * angular_radius_rad.to_degrees()
            ),
        }
    }
}

impl Serialize for Reason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
