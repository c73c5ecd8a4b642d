//! Numbers and poses in files, and the order of frames.

use glam::{DMat3, DMat4, DQuat, DVec3};

use super::error::{ImportError, ImportReason};
use super::imported::{ImportedFrame, MAX_FRAMES, MAX_NUMBER};
use super::paths::natural;

/// Limit for a time, in seconds.
const MAX_TIME_S: f64 = 1e10;
/// Largest deviation of lengths, angles and determinant from a rotation's: some files have four
/// digits.
const ROUNDED: f64 = 0.02;

/// OpenCV's camera axes (y down, z forward) from ours, and the inverse.
pub(super) const OPENCV_FROM_CAMERA: DMat4 = DMat4::from_cols_array(&[
    1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
]);

/// A finite number of a file within the limit for cameras.
pub(super) fn number(file: &str, field: &str, value: f64) -> Result<f64, ImportError> {
    if value.abs() <= MAX_NUMBER {
        Ok(value)
    } else {
        Err(ImportError::new(
            file,
            field,
            ImportReason::NotANumber(value.to_string()),
        ))
    }
}

/// A time of a file, in seconds.
pub(super) fn time_s(file: &str, field: &str, value: f64) -> Result<f64, ImportError> {
    if value.abs() <= MAX_TIME_S {
        Ok(value)
    } else {
        Err(ImportError::new(file, field, ImportReason::NotATime(value)))
    }
}

/// Exactly `N` numbers.
pub(super) fn numbers<const N: usize>(
    file: &str,
    field: &str,
    (values, expected): (&[f64], &'static str),
) -> Result<[f64; N], ImportError> {
    let n = values.len();
    let wrong = ImportReason::Length { n, expected };
    let all: [f64; N] = values
        .try_into()
        .map_err(|_| ImportError::new(file, field, wrong))?;
    for value in all {
        number(file, field, value)?;
    }
    Ok(all)
}

/// A pose from a quaternion (x, y, z, w) of about unit length and a position.
pub(super) fn pose(
    file: &str,
    field: &str,
    quaternion: [f64; 4],
    position: [f64; 3],
) -> Result<DMat4, ImportError> {
    for value in quaternion.iter().chain(&position) {
        number(file, field, *value)?;
    }
    let rotation = DQuat::from_array(quaternion);
    if rotation.length() < 0.5 {
        return Err(ImportError::new(file, field, ImportReason::NoRotation));
    }
    Ok(DMat4::from_rotation_translation(
        rotation.normalize(),
        DVec3::from_array(position),
    ))
}

/// Whether columns are at right angles, of one length and not mirrored.
pub(super) fn is_scaled_rotation(matrix: &DMat3) -> bool {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let squares = [x, y, z].map(DVec3::length_squared);
    let largest = squares.into_iter().fold(0.0, f64::max);
    let near = |difference: f64| difference.abs() <= ROUNDED * largest;
    largest.is_normal()
        && matrix.determinant() > 0.0
        && squares.into_iter().all(|square| near(largest - square))
        && [x.dot(y), y.dot(z), z.dot(x)].into_iter().all(near)
}

/// A pose from a rotation, row by row, and a position.
pub(super) fn pose_of_rows(
    file: &str,
    field: &str,
    rows: [f64; 9],
    position: [f64; 3],
) -> Result<DMat4, ImportError> {
    let rotation = DMat3::from_cols_array(&rows).transpose();
    if !is_scaled_rotation(&rotation) || (rotation.determinant() - 1.0).abs() > ROUNDED {
        return Err(ImportError::new(file, field, ImportReason::NotARotation));
    }
    let rotation = DQuat::from_mat3(&rotation).normalize();
    pose(file, field, rotation.to_array(), position)
}

/// Frames in the order of their times, or else of their pictures' names. Refuses an empty list, and
/// one that is too long.
pub(super) fn ordered(
    file: &str,
    mut frames: Vec<ImportedFrame>,
    first: Option<String>,
) -> Result<Vec<ImportedFrame>, ImportError> {
    let refused = |reason| Err(ImportError::new(file, "the frames", reason));
    match frames.len() {
        0 => return refused(ImportReason::NoFrames { first }),
        n if n > MAX_FRAMES => return refused(ImportReason::TooMany(MAX_FRAMES)),
        _ => {}
    }
    frames.sort_by(|a, b| natural(&a.image, &b.image));
    let times: Option<Vec<f64>> = frames.iter().map(|frame| frame.time_s).collect();
    if times.is_some() {
        let key = |frame: &ImportedFrame| frame.time_s.unwrap_or(0.0);
        frames.sort_by(|a, b| key(a).total_cmp(&key(b)));
    }
    Ok(frames)
}

/// The note about frames that have no picture.
pub(super) fn without_picture(missing: &[String], n_frames: usize) -> Option<String> {
    let first = missing.first()?;
    let n_missing = missing.len();
    Some(format!(
        "{n_missing} of {n_frames} frames have no picture and are skipped; the first is {first:?}"
    ))
}
