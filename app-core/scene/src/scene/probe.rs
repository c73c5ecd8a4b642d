//! A light probe: its shape, and its pictures.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DMat4;

use super::check::{self, FieldError, InputError};
use super::{Camera, Image};

/// Largest number of a probe's pictures.
pub const MAX_PROBE_PICTURES: usize = 64;
/// Largest number of pictures besides the first.
pub const MAX_FURTHER_PICTURES: usize = MAX_PROBE_PICTURES - 1;
/// Largest number of facets in a slope table.
pub const MAX_FACETS: usize = 1024;

/// A mirror of known shape in the scene that reflects the lights.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Its shape.
    pub shape: ProbeShape,
    /// Pictures of it, underexposed so that little but the lights is bright, in the order of time.
    pub pictures: Vec<ProbePicture>,
}

/// The shape of a probe.
///
/// Probe space is in metres, right-handed, and has its origin in the centre of the disc or ball.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeShape {
    /// A flat reflective Fresnel lens: a disc in local y = 0, its front along local +Y, whose facets are rings about its axis.
    FresnelLens {
        /// Radius of the disc, in metres.
        radius_m: f64,
        /// Slope of its facets.
        slope: FacetSlope,
    },
    /// A mirror ball; only the position of its pose matters.
    MirrorBall {
        /// Radius, in metres.
        radius_m: f64,
    },
}

/// Slope of a lens's facets: the angle between a facet's normal, which leans away from the axis, and the lens's.
#[derive(Clone, Debug, PartialEq)]
pub enum FacetSlope {
    /// The slope of the hemisphere above the disc, as in the paper: asin(distance from the axis /
    /// radius).
    Hemisphere,
    /// The slope of a convex mirror with a virtual focus behind it: half of atan(distance from the
    /// axis / focal length).
    Focal {
        /// Focal length, in metres.
        focal_m: f64,
    },
    /// A calibration table, in order of the distances from the axis; linear between entries, and 0
    /// on the axis.
    Table(Vec<Facet>),
}

impl FacetSlope {
    /// Slope of a facet, in radians, by its distance from the axis over the lens's radius.
    #[must_use]
    pub fn at(&self, of_radius: f64, radius_m: f64) -> f64 {
        match self {
            Self::Hemisphere => of_radius.clamp(0.0, 1.0).asin(),
            Self::Focal { focal_m } => 0.5 * (of_radius * radius_m).atan2(*focal_m),
            Self::Table(facets) => interpolated(facets, of_radius),
        }
    }
}

/// Slope of one facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Its distance from the axis over the radius of the lens, above 0 and at most 1.
    pub at: f64,
    /// In radians, from 0 to less than a right angle.
    pub slope_rad: f64,
}

/// A picture of a probe.
#[derive(Clone, Debug)]
pub struct ProbePicture {
    /// sRGB codes; in a session, of the session's size.
    pub image: Arc<Image>,
    /// The camera of the picture.
    pub camera: Camera,
    /// Rigid transform: the probe's pose.
    pub world_from_probe: DMat4,
    /// Exposure of `image` over that of a frame, above 0 and at most 1.
    pub exposure_ratio: f64,
}

impl Probe {
    /// Validates shape and pictures, whose fields are below `field`.
    pub(crate) fn check(&self, field: &str) -> Result<(), InputError> {
        self.shape.check(&format!("{field}.shape"))?;
        let n_pictures = check::at_most(self.pictures.len(), MAX_PROBE_PICTURES);
        InputError::at(&format!("{field}.pictures"), n_pictures)?;
        for (index, picture) in self.pictures.iter().enumerate() {
            picture.check(&format!("{field}.pictures[{index}]"))?;
        }
        Ok(())
    }
}

impl ProbeShape {
    /// Radius of disc or ball, in metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        match self {
            Self::FresnelLens { radius_m, .. } | Self::MirrorBall { radius_m } => *radius_m,
        }
    }

    /// Refuses an invalid shape; `field` is its place in the session.
    ///
    /// # Errors
    /// When a length is out of range, or facets are too many or out of order.
    pub fn check(&self, field: &str) -> Result<(), InputError> {
        let length = |name: &str, value| {
            InputError::at(&format!("{field}.{name}"), check::number(value, &check::EXTENT_M))
        };
        length("radius_m", self.radius_m())?;
        match self {
            Self::FresnelLens {
                slope: FacetSlope::Focal { focal_m },
                ..
            } => length("focal_m", *focal_m).map(drop),
            Self::FresnelLens {
                slope: FacetSlope::Table(facets),
                ..
            } => check_facets(field, facets),
            _ => Ok(()),
        }
    }
}

fn check_facets(field: &str, facets: &[Facet]) -> Result<(), InputError> {
    let list = format!("{field}.facets");
    if facets.is_empty() {
        return InputError::at(&list, Err(FieldError::Empty));
    }
    InputError::at(&list, check::at_most(facets.len(), MAX_FACETS))?;
    let mut before = f64::NEG_INFINITY;
    for (index, facet) in facets.iter().enumerate() {
        let at = check::number(facet.at, &check::OF_RADIUS);
        let at = at.and_then(|at| {
            if at > before {
                Ok(at)
            } else {
                Err(FieldError::Unordered)
            }
        });
        before = facet.at;
        InputError::at(&format!("{list}[{index}].at"), at)?;
        let slope_deg = check::number(facet.slope_rad.to_degrees(), &check::SLOPE_DEG);
        InputError::at(&format!("{list}[{index}].slope, in degrees"), slope_deg)?;
    }
    Ok(())
}

impl ProbePicture {
    /// Refuses an invalid picture; `field` is its place in the session.
    ///
    /// # Errors
    /// When a value of its camera or its size is out of range.
    pub fn check(&self, field: &str) -> Result<(), InputError> {
        check::camera(&format!("{field}.camera"), &self.camera)?;
        let pose = check::rigid(self.world_from_probe.to_cols_array());
        InputError::at(&format!("{field}.world_from_probe"), pose)?;
        let ratio = check::number(self.exposure_ratio, &check::EXPOSURE_RATIO);
        InputError::at(&format!("{field}.exposure_ratio"), ratio)?;
        Ok(())
    }
}

/// Linear between the entries, and extrapolated from the last two.
fn interpolated(facets: &[Facet], of_radius: f64) -> f64 {
    let axis = Facet {
        at: 0.0,
        slope_rad: 0.0,
    };
    let next = facets.partition_point(|facet| facet.at < of_radius);
    let next = next.min(facets.len().saturating_sub(1));
    let Some(above) = facets.get(next) else {
        return 0.0;
    };
    let below = next
        .checked_sub(1)
        .and_then(|before| facets.get(before))
        .unwrap_or(&axis);
    let span = above.at - below.at;
    let part = if span > 0.0 {
        (of_radius - below.at) / span
    } else {
        1.0
    };
    (below.slope_rad + part * (above.slope_rad - below.slope_rad)).clamp(0.0, FRAC_PI_2)
}
