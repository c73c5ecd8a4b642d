//! Errors of a session, each with file, field and reason.

use thiserror::Error;

use super::files::FileError;
use app_scene::place_mesh::PlaceMeshError;
use app_scene::scene::FieldError;
use app_scene::toy::ToyError;
use app_scene::words::Text;

/// A session or a frame that cannot be used.
#[derive(Debug, Error)]
#[error("{file} ({field}): {kind}")]
pub struct SessionError {
    /// The file, relative to the session.
    pub file: String,
    /// The field, or for another file the field that names it, for example `frames[3].image`.
    pub field: String,
    /// The reason.
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
    /// Not JSON, or not the JSON of the format.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// An unsupported format.
    #[error("the format is {:?}, but only {supported:?} can be read", Text(found).to_string())]
    Format {
        /// The format as written.
        found: String,
        /// The only supported format.
        supported: &'static str,
    },
    /// An unsupported version of the format.
    #[error("version {found} of the format is not supported, only version {supported} is")]
    Version {
        /// The version as written.
        found: u64,
        /// The only supported version.
        supported: u64,
    },
    /// A value that the format does not allow.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A picture that cannot be used.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A toy that cannot be used, or a clip that does not exist.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// A mesh of the place that cannot be used.
    #[error(transparent)]
    PlaceMesh(#[from] PlaceMeshError),
    /// An index beyond the last frame.
    #[error("the session has {n_frames} frames, counted from 0")]
    NoSuchFrame {
        /// Number of frames.
        n_frames: usize,
    },
}

/// The reason why a picture is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// An unknown format.
    #[error("neither PNG nor JPEG")]
    Format,
    /// A known but unsupported format.
    #[error("the picture is {format}, and only PNG and JPEG are read: {way_out}")]
    OtherFormat {
        /// The format.
        format: &'static str,
        /// The way to convert it.
        way_out: &'static str,
    },
    /// A size other than the session's; checked before decoding.
    #[error(
        "the picture is {width_px} x {height_px} px, but the session's is {expected_width_px} x {expected_height_px} px"
    )]
    Size {
        /// Width in the picture's header.
        width_px: u32,
        /// Height in the picture's header.
        height_px: u32,
        /// Width of the session.
        expected_width_px: u32,
        /// Height of the session.
        expected_height_px: u32,
    },
    /// A map of another shape than the session's pictures.
    #[error(
        "{map} of {width_px} x {height_px} px, which is not the shape of the session's pictures, {picture_width_px} x {picture_height_px} px: turn or cut it like the pictures"
    )]
    MapSize {
        /// The kind of map, with its article.
        map: &'static str,
        /// Width in the header.
        width_px: u32,
        /// Height in the header.
        height_px: u32,
        /// Width of the session's pictures.
        picture_width_px: u32,
        /// Height of the session's pictures.
        picture_height_px: u32,
    },
    /// A map that is no grey PNG of its number of bits.
    #[error("not a grey PNG of {n_bits} bits, as {map} must be")]
    NotAMap {
        /// The kind of map, with its article.
        map: &'static str,
        /// Number of bits of a pixel.
        n_bits: u8,
    },
    /// Damaged or cut short.
    #[error("damaged picture: {0}")]
    Decode(#[from] image::ImageError),
    /// A JPEG without its end; decoders would fill the rest with grey.
    #[error("damaged picture: the JPEG is cut short")]
    Truncated,
    /// A mask without a fourth channel.
    #[error("not an 8-bit RGBA picture, as a mask must be")]
    NotAMask,
}
