//! What is wrong with what is imported: always the file, the field and the reason.

use app_core::session::FileError;
use thiserror::Error;

/// A recording of another program that cannot be taken.
#[derive(Debug, Error)]
#[error("{file} ({field}): {reason}")]
pub struct ImportError {
    /// Relative to the folder.
    pub file: String,
    /// Path of the field, or line and column.
    pub field: String,
    /// Why.
    pub reason: ImportReason,
}

/// Why something cannot be taken.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportReason {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// Not JSON, or not that of the format.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// Not text.
    #[error("not UTF-8")]
    NotText,
    /// It is not there.
    #[error("missing")]
    Missing,
    /// It is not a number, or not a finite one.
    #[error("{0:?} is not a finite number")]
    NotANumber(String),
    /// A list of another length.
    #[error("{n} numbers, {expected} are needed")]
    Length {
        /// As found.
        n: usize,
        /// As needed.
        expected: &'static str,
    },
    /// Four numbers near nought.
    #[error("the quaternion has no direction")]
    NoRotation,
    /// A camera of another kind.
    #[error(
        "{0:?}: only pinholes with the radial terms k1 and k2 can be taken; undistort the pictures first"
    )]
    Lens(String),
    /// No frame has both a pose and a picture.
    #[error("no frame with a pose has a picture")]
    NoFrames,
    /// More than are taken.
    #[error("more than {0} frames")]
    TooMany(usize),
    /// Neither PNG nor JPEG, or damaged.
    #[error("neither a PNG nor a JPEG whose size can be read")]
    NotAPicture,
}

impl ImportError {
    pub(super) fn new(file: &str, field: impl Into<String>, reason: impl Into<ImportReason>) -> Self {
        Self {
            file: file.to_owned(),
            field: field.into(),
            reason: reason.into(),
        }
    }
}
