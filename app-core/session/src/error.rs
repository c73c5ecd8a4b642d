//! Errors of a session: always the file, the field and the reason.

use thiserror::Error;

use super::files::FileError;
use app_scene::scene::FieldError;
use app_scene::toy::ToyError;
use app_scene::words::Text;

/// A session that cannot be used, or a frame of it.
#[derive(Debug, Error)]
#[error("{file} ({field}): {kind}")]
pub struct SessionError {
    /// The file at fault, relative to the session.
    pub file: String,
    /// The field at fault, or for another file the field that names it, as in `frames[3].image`.
    pub field: String,
    /// What is wrong.
    pub kind: Box<SessionErrorKind>,
}

impl SessionError {
    pub(super) fn new(file: &str, field: &str, kind: impl Into<SessionErrorKind>) -> Self {
        Self {
            file: file.to_owned(),
            field: field.to_owned(),
            kind: Box::new(kind.into()),
        }
    }
}

/// The reason of a [`SessionError`].
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SessionErrorKind {
    /// The file itself cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// Not JSON, or not the JSON that the format asks for.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// Another format.
    #[error("the format is {:?}, but only {supported:?} can be read", Text(found).to_string())]
    Format {
        /// The format as written.
        found: String,
        /// The one format that is read.
        supported: &'static str,
    },
    /// Another version of the format.
    #[error("version {found} of the format is not supported, only version {supported} is")]
    Version {
        /// The version as written.
        found: u64,
        /// The one version that is read.
        supported: u64,
    },
    /// A value outside what the format allows.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A picture that cannot be used.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A toy that cannot be used, or a clip that it does not have.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// A frame beyond the last.
    #[error("the session has {n_frames} frames, counted from 0")]
    NoSuchFrame {
        /// Number of frames.
        n_frames: usize,
    },
}

/// Why a picture is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Not one of the two formats.
    #[error("neither PNG nor JPEG")]
    Format,
    /// Another format that is known.
    #[error("the picture is {format}, and only PNG and JPEG are read: {way_out}")]
    OtherFormat {
        /// What it is.
        format: &'static str,
        /// What makes a picture of it that is read.
        way_out: &'static str,
    },
    /// Another size than the session's; checked before anything is decoded.
    #[error(
        "the picture is {width_px} x {height_px} px, but the session's is {expected_width_px} x {expected_height_px} px"
    )]
    Size {
        /// Width that the picture's header states.
        width_px: u32,
        /// Height that the picture's header states.
        height_px: u32,
        /// Width of the session.
        expected_width_px: u32,
        /// Height of the session.
        expected_height_px: u32,
    },
    /// Damaged or cut short.
    #[error("damaged picture: {0}")]
    Decode(#[from] image::ImageError),
    /// A JPEG without its end, which decoders fill with grey.
    #[error("damaged picture: the JPEG is cut short")]
    Truncated,
    /// A mask without its fourth number.
    #[error("not an 8-bit RGBA picture, as a mask must be")]
    NotAMask,
}
