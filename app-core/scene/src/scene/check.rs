//! Validates numbers from a file, a tracker or a caller.
//!
//! The limits are far outside any real scene. They keep the 32-bit arithmetic on the GPU finite.

use std::ops::RangeInclusive;

use glam::{DMat3, DMat4, DVec3};

use thiserror::Error;

use super::{Camera, Intrinsics};
use crate::words::Number;

/// A refused value, and the path of its field.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field}: {reason}")]
pub struct InputError {
    /// Path of the field, as in `receivers[1].half_extent_m`.
    pub field: String,
    /// The reason.
    pub reason: FieldError,
}

impl InputError {
    /// Names the field that a check refused.
    pub(crate) fn at<T>(field: &str, checked: Result<T, FieldError>) -> Result<T, Self> {
        checked.map_err(|reason| Self {
            field: field.to_owned(),
            reason,
        })
    }
}

/// The reason why the value of a field is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FieldError {
    /// A number that is too small, too large or not a number.
    #[error("{} is not from {} to {}", Number(*value), Number(*min), Number(*max))]
    Range {
        /// The number as written.
        value: f64,
        /// Smallest allowed.
        min: f64,
        /// Largest allowed.
        max: f64,
    },
    /// A time that is too early, too late or not a number.
    #[error(
        "{} s is not from {} s to {} s: times are in seconds",
        Number(*secs),
        Number(*min_secs),
        Number(*max_secs)
    )]
    Time {
        /// The time as written.
        secs: f64,
        /// Earliest allowed.
        min_secs: f64,
        /// Latest allowed.
        max_secs: f64,
    },
    /// A list that needs an entry.
    #[error("the list is empty, but needs at least one entry")]
    Empty,
    /// A list with more entries than the limit.
    #[error("the list has {n} entries, but the limit is {max}")]
    TooMany {
        /// Its length.
        n: usize,
        /// The limit.
        max: usize,
    },
    /// A field that is required for this kind of entry.
    #[error("missing, but required for this kind")]
    Missing,
    /// A vector without a direction.
    #[error("the vector is too short to have a direction")]
    NoDirection,
    /// A direction of another length than 1.
    #[error("the vector is not of length 1")]
    NotAUnitVector,
    /// A list whose entries are not in their order.
    #[error("it is not above that of the entry before")]
    Unordered,
    /// A lens that maps two places to one.
    #[error("the lens folds the picture: with growing distance from its centre, places must stay in order")]
    Folds,
    /// A matrix whose last row is not 0 0 0 1.
    #[error("the matrix is not affine: its last row must be 0 0 0 1 (numbers are column-major)")]
    NotAffine,
    /// A matrix that is more than rotation and translation.
    #[error("the matrix is not rigid: its axes must be of length 1 and at right angles")]
    NotRigid,
    /// A matrix that stretches or shears.
    #[error("the matrix scales its axes differently or shears: only one scale for all is allowed")]
    NotUniform,
    /// A matrix that swaps handedness.
    #[error("the matrix mirrors: its axes must be right-handed")]
    Mirrored,
    /// A picture with more pixels than phones' cameras have.
    #[error("{width_px} x {height_px} px are more than the {max_pixels} pixels that a picture may have")]
    PictureTooLarge {
        /// Columns.
        width_px: u32,
        /// Rows.
        height_px: u32,
        /// The most pixels allowed.
        max_pixels: u64,
    },
    /// A map of a picture of another shape than the picture.
    #[error(
        "{width_px} x {height_px} px are not the shape of the picture, {picture_width_px} x {picture_height_px} px"
    )]
    OtherShape {
        /// Columns of the map.
        width_px: u32,
        /// Rows of the map.
        height_px: u32,
        /// Columns of the picture.
        picture_width_px: u32,
        /// Rows of the picture.
        picture_height_px: u32,
    },
    /// Pictures that would take more memory than a session may.
    #[error("the pictures hold more than {max_pixels} pixels in all")]
    TooManyPixels {
        /// Limit for the sum over all pictures.
        max_pixels: u64,
    },
}

/// Range of distances and coordinates, in metres.
pub const COORDINATE_M: RangeInclusive<f64> = -1e6..=1e6;
/// Range of lengths that must be positive, in metres.
pub const EXTENT_M: RangeInclusive<f64> = 1e-6..=1e6;
/// Range of lengths that may be zero, in metres.
pub const RADIUS_M: RangeInclusive<f64> = 0.0..=1e9;
/// Range of lights' coordinates, in metres: beyond the moon.
pub const LIGHT_M: RangeInclusive<f64> = -1e9..=1e9;
/// Limit for the pixels of one picture: a still of 4096 x 3072, larger than the pictures of
/// tracking cameras, which have at most 4032 x 3024. Maps of the whole picture take some 140 bytes
/// per pixel.
pub const MAX_PICTURE_PIXELS: u64 = 4096 * 3072;
/// Range of the width and height of a session's pictures, in pixels.
pub const SIDE_PX: RangeInclusive<f64> = 1.0..=16384.0;
/// Range of focal lengths, in pixels.
pub const FOCAL_PX: RangeInclusive<f64> = 1e-3..=1e6;
/// Range of positions in a picture or beside it, in pixels.
pub const POSITION_PX: RangeInclusive<f64> = -1e6..=1e6;
/// Range of frames' times, in seconds: three hundred years in both directions.
pub const TIME_SECS: RangeInclusive<f64> = -1e10..=1e10;
/// Range of times within a clip, in seconds.
pub const CLIP_TIME_SECS: RangeInclusive<f64> = 0.0..=1e10;
/// Range of a light's angular radius, in degrees: less than half the sky.
pub const ANGULAR_RADIUS_DEG: RangeInclusive<f64> = 0.0..=89.999;
/// Range of pictures' exposures, relative to a reference common to all of a scene.
pub const EXPOSURE: RangeInclusive<f64> = 1e-9..=1e9;
/// Range of a darker picture's exposure over that of a frame.
pub const EXPOSURE_RATIO: RangeInclusive<f64> = 1e-6..=1.0;
/// Range of a facet's distance from its lens's axis, over the lens's radius.
pub const OF_RADIUS: RangeInclusive<f64> = 1e-6..=1.0;
/// Range of facets' slopes, in degrees: less than a right angle.
pub const SLOPE_DEG: RangeInclusive<f64> = 0.0..=89.9;
/// Range of light intensities, in any unit.
pub const INTENSITY: RangeInclusive<f64> = 0.0..=1e9;
/// Range of radiance coefficients.
pub const HARMONIC: RangeInclusive<f64> = -1e9..=1e9;
/// Range of colour temperatures, in kelvin.
pub const KELVIN: RangeInclusive<f64> = 100.0..=1e6;
/// Range of a place's uncertainty, in metres.
pub const UNCERTAINTY_M: RangeInclusive<f64> = 0.0..=1e6;
pub(crate) const UNCERTAINTY_RAD: RangeInclusive<f64> = 0.0..=std::f64::consts::PI;
/// Range of a direction's uncertainty, in degrees.
pub const UNCERTAINTY_DEG: RangeInclusive<f64> = 0.0..=180.0;
/// Range of a distance's or a size's uncertainty, as a factor.
pub const UNCERTAINTY_RATIO: RangeInclusive<f64> = 1.0..=1e3;
const SCALE: RangeInclusive<f64> = 1e-6..=1e6;

/// Largest deviation of a rotation's axes from unit length and right angles: enough for numbers
/// rounded to a few digits, but not for a wrong convention.
const AXES_TOLERANCE: f64 = 1e-3;

/// A number within a range, ends included. Infinities and NaN are refused.
pub fn number(value: f64, range: &RangeInclusive<f64>) -> Result<f64, FieldError> {
    if range.contains(&value) {
        Ok(value)
    } else {
        Err(FieldError::Range {
            value,
            min: *range.start(),
            max: *range.end(),
        })
    }
}

/// A time within a range of seconds, ends included.
pub fn time_secs(secs: f64, range: &RangeInclusive<f64>) -> Result<f64, FieldError> {
    number(secs, range).map_err(|_| FieldError::Time {
        secs,
        min_secs: *range.start(),
        max_secs: *range.end(),
    })
}

/// The size of a picture.
pub fn picture_size(width_px: u32, height_px: u32) -> Result<(), FieldError> {
    if u64::from(width_px) * u64::from(height_px) > MAX_PICTURE_PIXELS {
        return Err(FieldError::PictureTooLarge {
            width_px,
            height_px,
            max_pixels: MAX_PICTURE_PIXELS,
        });
    }
    Ok(())
}

/// Whether a map of a picture, which may be coarser or finer, has the picture's shape; both are
/// width and height in pixels, and each side is rounded to whole pixels.
fn is_alike(size_px: [u32; 2], picture_px: [u32; 2]) -> bool {
    let [width, height] = size_px.map(f64::from);
    let [of_width, of_height] = picture_px.map(f64::from);
    (width * of_height - height * of_width).abs() <= of_width.max(of_height)
}

/// Refuses a map of a picture with too many pixels, or of another shape than the picture.
pub fn map_size(size_px: [u32; 2], picture_px: [u32; 2]) -> Result<(), FieldError> {
    let [width_px, height_px] = size_px;
    picture_size(width_px, height_px)?;
    if is_alike(size_px, picture_px) {
        return Ok(());
    }
    let [picture_width_px, picture_height_px] = picture_px;
    Err(FieldError::OtherShape {
        width_px,
        height_px,
        picture_width_px,
        picture_height_px,
    })
}

/// Refuses a list longer than the limit.
pub fn at_most(n: usize, max: usize) -> Result<(), FieldError> {
    if n <= max {
        Ok(())
    } else {
        Err(FieldError::TooMany { n, max })
    }
}

/// A point, in metres.
pub(crate) fn point(numbers: [f64; 3]) -> Result<DVec3, FieldError> {
    for value in numbers {
        number(value, &COORDINATE_M)?;
    }
    Ok(DVec3::from_array(numbers))
}

/// The position of a light, in metres.
pub fn light_position(numbers: [f64; 3]) -> Result<DVec3, FieldError> {
    for value in numbers {
        number(value, &LIGHT_M)?;
    }
    Ok(DVec3::from_array(numbers))
}

/// A direction of any length, normalised.
pub fn direction(numbers: [f64; 3]) -> Result<DVec3, FieldError> {
    let vector = point(numbers)?;
    if vector.length() < 1e-9 {
        return Err(FieldError::NoDirection);
    }
    vector.try_normalize().ok_or(FieldError::NoDirection)
}

/// A transform that only rotates and translates.
pub fn rigid(column_major: [f64; 16]) -> Result<DMat4, FieldError> {
    let matrix = affine(column_major)?;
    let axes = DMat3::from_mat4(matrix);
    if !has_unit_axes(axes) {
        return Err(FieldError::NotRigid);
    }
    if axes.determinant() < 0.0 {
        return Err(FieldError::Mirrored);
    }
    Ok(matrix)
}

/// A transform that rotates, translates and scales all axes equally.
pub fn similarity(column_major: [f64; 16]) -> Result<DMat4, FieldError> {
    let matrix = affine(column_major)?;
    let axes = DMat3::from_mat4(matrix);
    let scale = number(axes.x_axis.length(), &SCALE)?;
    let rotation = axes * scale.recip();
    if !has_unit_axes(rotation) {
        return Err(FieldError::NotUniform);
    }
    if rotation.determinant() < 0.0 {
        return Err(FieldError::Mirrored);
    }
    Ok(matrix)
}

fn affine(column_major: [f64; 16]) -> Result<DMat4, FieldError> {
    for value in column_major {
        number(value, &COORDINATE_M)?;
    }
    let matrix = DMat4::from_cols_array(&column_major);
    let last_row = matrix.row(3);
    if last_row.abs_diff_eq(glam::DVec4::W, 1e-6) {
        Ok(matrix)
    } else {
        Err(FieldError::NotAffine)
    }
}

fn has_unit_axes(axes: DMat3) -> bool {
    (axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, AXES_TOLERANCE)
}

/// A camera, whose fields are below `field`.
pub fn camera(field: &str, camera: &Camera) -> Result<(), InputError> {
    intrinsics(&format!("{field}.intrinsics"), &camera.intrinsics)?;
    let world_from_camera = rigid(camera.world_from_camera.to_cols_array());
    InputError::at(&format!("{field}.world_from_camera"), world_from_camera)?;
    Ok(())
}

fn intrinsics(field: &str, intrinsics: &Intrinsics) -> Result<(), InputError> {
    let Intrinsics {
        fx_px,
        fy_px,
        cx_px,
        cy_px,
    } = *intrinsics;
    let numbers = [
        ("fx_px", fx_px, FOCAL_PX),
        ("fy_px", fy_px, FOCAL_PX),
        ("cx_px", cx_px, POSITION_PX),
        ("cy_px", cy_px, POSITION_PX),
    ];
    for (name, value, range) in numbers {
        InputError::at(&format!("{field}.{name}"), number(value, &range))?;
    }
    Ok(())
}

/// A vector of length 1.
pub(crate) fn unit(direction: DVec3) -> Result<(), FieldError> {
    if direction.is_normalized() {
        Ok(())
    } else {
        Err(FieldError::NotAUnitVector)
    }
}
