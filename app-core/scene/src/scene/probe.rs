//! A light probe: what it is, and the pictures of it.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DMat4;

use super::check::{self, FieldError, InputError};
use super::{Camera, Image};

/// Pictures that a probe may have.
pub const MAX_PROBE_PICTURES: usize = 64;
/// Of these, those besides the first.
pub const MAX_FURTHER_PICTURES: usize = MAX_PROBE_PICTURES - 1;
/// Facets whose slope may be told.
pub const MAX_FACETS: usize = 1024;

/// A mirror of a known shape that lies in the scene and shows the lights.
#[derive(Clone, Debug)]
pub struct Probe {
    /// What it is.
    pub shape: ProbeShape,
    /// Pictures of it, underexposed so that little but the lights is bright, in the order that they were taken.
    pub pictures: Vec<ProbePicture>,
}

/// What a probe is.
///
/// Probe space is in metres, right-handed, and has its origin in the middle of the disc or ball.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbeShape {
    /// A flat reflective Fresnel lens: a disc in local y = 0, its front along local +Y, whose facets are rings about its axis.
    FresnelLens {
        /// Of the disc, in metres.
        radius_m: f64,
        /// How steep its facets are.
        slope: FacetSlope,
    },
    /// A mirror ball, of whose pose the place alone counts.
    MirrorBall {
        /// In metres.
        radius_m: f64,
    },
}

/// Slope of a lens's facets: the angle between a facet's normal, which leans away from the axis, and the lens's.
#[derive(Clone, Debug, PartialEq)]
pub enum FacetSlope {
    /// That of the hemisphere above the disc, as the paper takes it: asin(distance from the axis / radius).
    Hemisphere,
    /// Of a convex mirror that spreads light as if from a focus behind it: half of atan(distance from the axis / focal length).
    Focal {
        /// In metres.
        focal_m: f64,
    },
    /// As calibrated, in order of their distances from the axis; straight lines between them, and 0 on the axis.
    Table(Vec<Facet>),
}

impl FacetSlope {
    /// Of a facet, in radians, by its distance from the axis over the lens's radius.
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
    /// sRGB codes, of the session's size where it is a session's.
    pub image: Arc<Image>,
    /// The camera that took it.
    pub camera: Camera,
    /// Rigid transform: where the probe was.
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
    /// Of disc or ball, in metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        match self {
            Self::FresnelLens { radius_m, .. } | Self::MirrorBall { radius_m } => *radius_m,
        }
    }

    /// Refuses a shape that cannot be; `field` is its place in the session.
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
    /// Refuses a picture that cannot be; `field` is its place in the session.
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

/// Between the entries on either side; as the last two beyond them.
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
