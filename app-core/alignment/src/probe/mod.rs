//! Lights by a probe: a flat Fresnel lens or a mirror ball that lies in the scene, in underexposed pictures.
//!
//! Source: Casas et al. 2019, section 3, «Enhanced Shadow Retargeting with Light-Source Estimation Using Flat Fresnel Lenses».
//! A mirror of known shape and pose shows each light in one place, and the law of reflection says where that light is. The pictures
//! are so dark that little but lights is bright in them.
//!
//! ```text
//! ProbeView ─► highlights ─► reading, or published ─► Sighting ─┐
//!                                        earlier views ─────────┴► Track ─► TrackedLight
//! ```
//!
//! # As published, and what differs here
//!
//! [`Form::Published`] is the paper's own: pixels whose channels are all above .9 (equation 2), their middle (equation 3), the
//! hemisphere's normal N there, and L = 2 (N · R) N − R with R = (0, 0, 1) (equation 4).
//! R has to be the direction to the viewer, who is thus taken to be far away on the lens's axis. Reflection in a fixed N keeps
//! angles, so L is wrong by exactly the angle between the axis and the true direction to the viewer.
//! [`Form::Exact`] takes that direction for each pixel instead; its facets may be others than the hemisphere's ([`FacetSlope`](app_scene::scene::FacetSlope)), which
//! a real lens has to be calibrated for ([`facet_at`]); its middles are weighted by light and solid angle; and regions that are no
//! light's are rejected.
//!
//! Errata of the paper, as far as they matter here:
//! - Equation 1's r is the largest distance within the lens, that is the lens's radius, of which the hemisphere of equation 4 is made;
//!   the text feeds the same r to the soft shadow as the light's size. The caption of figure 10 says «radius of the highly saturated
//!   region», which is taken here; r is the radius of the known lens.
//! - Equation 3 has |h| for the number of all bright pixels, but the text says that it is taken for each region.
//! - Beyond .71 of the radius the hemisphere sends a viewer on the axis below the horizon.
//!
//! A highlight is a first guess. It lies where the probe is, so that a near light stands elsewhere over the toy, unless several
//! views tell its distance ([`Track`]); and it is a few pixels large, so that its size says little of the light's. Alignment corrects
//! both by the shadow.

mod ball;
mod error;
mod eye;
mod highlights;
mod lens;
mod look;
mod near_light;
mod published;
mod reading;
mod reflection;
mod surface;
mod track;

use glam::{DVec2, DVec3};
use serde::{Serialize, Serializer};

use app_scene::scene::{ProbePicture, ProbeShape};

pub use error::ProbeError;
pub use look::{facet_at, look};
pub use track::{ProbeReport, Track, TrackedLight};

/// A picture of a probe: image, intrinsics, pose of the camera, pose and shape of the probe.
#[derive(Clone, Copy, Debug)]
pub struct ProbeView<'a> {
    /// What the probe is.
    pub shape: &'a ProbeShape,
    /// The picture, its camera, and where the probe was.
    pub picture: &'a ProbePicture,
}

/// How highlights become lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// By the true direction to the viewer, with regions that are no light's rejected.
    #[default]
    Exact,
    /// The paper's: the viewer on the axis, of a ball on that from its middle; each bright region is a light.
    Published,
}

/// What a picture of a probe shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sighting {
    /// Lights, those that give most first.
    pub lights: Vec<SeenLight>,
    /// Bright regions that are none, in the order of their rows.
    pub rejected: Vec<Rejected>,
}

/// A light in one picture of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeenLight {
    /// Where the probe shows it, in the world, metres.
    pub origin_in_world: DVec3,
    /// Unit vector from there.
    pub direction_in_world: DVec3,
    /// One deviation of the direction, in radians: what a tenth of a pixel makes of it.
    pub deviation_rad: f64,
    /// Half the angle that it fills, in radians, as far as its highlight tells.
    pub angular_radius_rad: f64,
    /// Linear light times solid angle, in units of the picture's white; less than it is where the picture is white.
    pub power: f64,
    /// Middle of the highlight, in pixels.
    pub at_px: DVec2,
}

/// A bright region that is no light's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rejected {
    /// Its middle, in pixels.
    pub at_px: DVec2,
    /// Why.
    pub reason: Reason,
}

/// Why a region is no light's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// It is long, as the streaks are that the back walls of facets make; lights are round.
    Streak {
        /// Its length over its width, as angles in the mirror.
        elongation: f64,
    },
    /// It goes on beyond the probe's border, so that its middle is not known.
    AtRim,
    /// What is mirrored there lies below the lens.
    BelowLens,
    /// It fills more of the sky than a light does whose shadow has a shape: the picture is not dark enough, or a window is seen.
    TooWide {
        /// Half the angle, in radians.
        angular_radius_rad: f64,
    },
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Streak { elongation } => {
                write!(f, "it is a streak, {elongation:.1} times as long as wide")
            }
            Self::AtRim => f.write_str("it goes on beyond the probe's border"),
            Self::BelowLens => f.write_str("what is mirrored there lies below the lens"),
            Self::TooWide { angular_radius_rad } => write!(
                f,
                "it fills {:.0} degrees: the picture is not dark enough",
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
