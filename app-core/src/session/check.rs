//! Turns numbers from a file into values that the rest of the core may trust.
//!
//! The limits are far outside any real scene. They keep the 32-bit arithmetic on the GPU finite.

use std::ops::RangeInclusive;

use glam::{DMat3, DMat4, DVec3};

use super::error::FieldError;

/// Distances and coordinates, in metres.
pub(super) const COORDINATE_M: RangeInclusive<f64> = -1e6..=1e6;
/// Lengths of things that must have an extent, in metres.
pub(super) const EXTENT_M: RangeInclusive<f64> = 1e-6..=1e6;
/// Lengths of things that may be points, in metres.
pub(super) const RADIUS_M: RangeInclusive<f64> = 0.0..=1e6;
/// Focal lengths, in pixels.
pub(super) const FOCAL_PX: RangeInclusive<f64> = 1e-3..=1e6;
/// Positions in a picture or beside it, in pixels.
pub(super) const POSITION_PX: RangeInclusive<f64> = -1e6..=1e6;
/// Times of frames, in seconds: three hundred years either way.
pub(super) const TIME_SECS: RangeInclusive<f64> = -1e10..=1e10;
/// Times within a clip, in seconds.
pub(super) const CLIP_TIME_SECS: RangeInclusive<f64> = 0.0..=1e10;
/// Half the angle of a light's disc, in degrees: less than half the sky.
pub(super) const ANGULAR_RADIUS_DEG: RangeInclusive<f64> = 0.0..=89.999;
/// Exposure of a darker picture over that of a frame.
pub(super) const EXPOSURE_RATIO: RangeInclusive<f64> = 1e-6..=1.0;
const SCALE: RangeInclusive<f64> = 1e-6..=1e6;

/// How far a rotation's axes may be from unit length and right angles: what rounding to a few
/// digits does, and not what a wrong convention does.
const AXES_TOLERANCE: f64 = 1e-3;

/// A number within a range, ends included. Infinities and NaN never are.
pub(super) fn number(value: f64, range: &RangeInclusive<f64>) -> Result<f64, FieldError> {
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

/// A point, in metres.
pub(super) fn point(numbers: [f64; 3]) -> Result<DVec3, FieldError> {
    for value in numbers {
        number(value, &COORDINATE_M)?;
    }
    Ok(DVec3::from_array(numbers))
}

/// A direction of any length, made a unit vector.
pub(super) fn direction(numbers: [f64; 3]) -> Result<DVec3, FieldError> {
    let vector = point(numbers)?;
    if vector.length() < 1e-9 {
        return Err(FieldError::NoDirection);
    }
    vector.try_normalize().ok_or(FieldError::NoDirection)
}

/// A transform that only rotates and moves.
pub(super) fn rigid(column_major: [f64; 16]) -> Result<DMat4, FieldError> {
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

/// A transform that rotates, moves and scales all axes alike.
pub(super) fn similarity(column_major: [f64; 16]) -> Result<DMat4, FieldError> {
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
