//! Paths of fields in `capture.json`, for the errors.

use crate::error::{SessionError, SessionErrorKind};
use crate::files::{FileError, Files, INDEX_FILE, check_path};
use app_scene::scene::FieldError;

/// The distortion, from which each camera's lens is made.
pub(super) const LENS: &str = "lens";
/// Path for errors of no single field.
pub(super) const WHOLE_FILE: &str = "the whole file";

/// Refuses an invalid path at once, before the file is read.
pub(super) fn check_named(path: &str, field: &str) -> Result<(), SessionError> {
    check_path(path).map_err(|error| in_index(field, FileError::from(error)))
}

/// An error of `capture.json` itself.
pub(super) fn in_index(field: &str, kind: impl Into<SessionErrorKind>) -> SessionError {
    SessionError::new(INDEX_FILE, field, kind)
}

pub(super) fn frame_field(index: usize, rest: &str) -> String {
    format!("frames[{index}]{rest}")
}

/// Puts the field's path into the error of a check.
pub(super) fn at<T>(field: &str, checked: Result<T, FieldError>) -> Result<T, SessionError> {
    checked.map_err(|error| in_index(field, error))
}

/// Converts a list, passing each entry its path.
pub(super) fn each<R, T>(
    field: &str,
    records: &[R],
    mut convert: impl FnMut(&str, &R) -> Result<T, SessionError>,
) -> Result<Vec<T>, SessionError> {
    let entries = records.iter().enumerate();
    entries
        .map(|(i, record)| convert(&format!("{field}[{i}]"), record))
        .collect()
}

pub(super) fn non_empty<R, T>(
    field: &str,
    records: &[R],
    convert: impl Fn(&str, &R) -> Result<T, SessionError>,
) -> Result<Vec<T>, SessionError> {
    if records.is_empty() {
        return Err(in_index(field, FieldError::Empty));
    }
    each(field, records, convert)
}

/// Reads a file that a field of `capture.json` names.
pub(super) fn read_named(
    files: &dyn Files,
    path: &str,
    field: &str,
    max_bytes: u64,
) -> Result<Vec<u8>, SessionError> {
    check_named(path, field)?;
    files
        .read(path, max_bytes)
        .map_err(|error| SessionError::new(path, field, error))
}
