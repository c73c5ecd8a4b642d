//! Import errors, each with file, field and reason.

use app_core::scene::FieldError;
use app_core::session::FileError;
use thiserror::Error;

/// A recording of another program that cannot be imported.
#[derive(Debug, Error)]
#[error("{file} ({field}): {reason}")]
pub struct ImportError {
    /// Relative to the folder.
    pub file: String,
    /// Path of the field, or line and column.
    pub field: String,
    /// The reason.
    pub reason: ImportReason,
}

/// The reason why a recording cannot be imported.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportReason {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The text is no JSON, or not that of the format.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// A value out of range.
    #[error(transparent)]
    Field(FieldError),
    /// The file is not text.
    #[error("not UTF-8")]
    NotText,
    /// The file or field does not exist.
    #[error("missing")]
    Missing,
    /// A file that is no archive, in place of a folder.
    #[error("neither a folder nor a ZIP archive, as Record3D's .r3d is")]
    NotAnArchive,
    /// The value is no number, or not a finite one.
    #[error("{0:?} is not a finite number of at most {max:e}", max = super::imported::MAX_NUMBER)]
    NotANumber(String),
    /// A time outside of every clock's range.
    #[error("{0} is no time in seconds: it must be from -1e10 to 1e10")]
    NotATime(f64),
    /// A list of another length.
    #[error("{n} numbers, {expected} are needed")]
    Length {
        /// Number of values in the file.
        n: usize,
        /// Number of values needed.
        expected: &'static str,
    },
    /// A quaternion near zero.
    #[error("the quaternion has no direction")]
    NoRotation,
    /// A matrix that is no rotation.
    #[error("the matrix is no rotation")]
    NotARotation,
    /// A matrix that shears, mirrors or projects.
    #[error(
        "the matrix is no pose: its columns must be at right angles, of one length and not mirrored, and its last row 0 0 0 1"
    )]
    NotAPose,
    /// An unsupported camera model.
    #[error(
        "{0:?}: that camera model cannot be taken: undistort the pictures first, as `colmap image_undistorter` or `ns-process-data` do"
    )]
    Lens(String),
    /// A lens that cannot be inverted over the picture.
    #[error("the lens {lens}: {reason}; undistort the pictures first")]
    Folds {
        /// Its coefficients.
        lens: String,
        /// The reason.
        reason: FieldError,
    },
    /// No frame has both a pose and a picture.
    #[error("no frame with a pose has a picture{}", looked_for(first))]
    NoFrames {
        /// The first picture named; `None` if the format does not name any.
        first: Option<String>,
    },
    /// More frames than the limit.
    #[error("it has more than {0} frames: split it, or import every second frame")]
    TooMany(usize),
    /// Two frames whose paths lead to one picture.
    #[error(
        "this picture is found at {0:?}, as another frame's is: the folder must hold both, as deep as the paths say"
    )]
    Twice(String),
    /// Pictures of which it is unknown whether they are numbered from 0 or from 1.
    #[error(
        "the pictures are numbered from {} to {}, the frames from 0 to {last_frame}: which picture is the first frame's cannot be known; extract all frames, and number them from 0, as by `ffmpeg -start_number 0`",
        numbers[0],
        numbers[1]
    )]
    Numbering {
        /// First and last number of a picture.
        numbers: [u64; 2],
        /// Last frame of the index.
        last_frame: u64,
    },
    /// A picture in a known format that cannot be read.
    #[error("the picture is {format}, and only PNG and JPEG are read: {way_out}")]
    OtherFormat {
        /// The picture's format.
        format: &'static str,
        /// The way to convert it.
        way_out: &'static str,
    },
    /// Neither PNG nor JPEG, or damaged.
    #[error("neither a PNG nor a JPEG whose size can be read")]
    NotAPicture,
    /// Depths or confidences of another kind.
    #[error(
        "not what a depth sensor's picture is: grey PNGs of 16 bit for depths and of 8 bit for confidences, of one size; or the .depth and .conf of Record3D, of its dw x dh"
    )]
    NotDepths,
    /// A picture whose size differs from the first.
    #[error(
        "it is {} x {} px, but {first} is {} x {} px: all pictures of a session have one size",
        size_px[0],
        size_px[1],
        first_px[0],
        first_px[1]
    )]
    Sizes {
        /// Its size.
        size_px: [u32; 2],
        /// The first picture.
        first: String,
        /// The first picture's size.
        first_px: [u32; 2],
    },
    /// A picture that is no scaled version of the intrinsics' picture.
    #[error(
        "it is {} x {} px, but its intrinsics are of {} x {} px, which are no multiple of it: give the pictures that the cameras were found with, neither cropped nor turned",
        size_px[0],
        size_px[1],
        stated_px[0],
        stated_px[1]
    )]
    Aspect {
        /// Its size.
        size_px: [u32; 2],
        /// The size in the index.
        stated_px: [f64; 2],
    },
    /// A picture whose centre is far from the principal point.
    #[error(
        "it is {} x {} px, but its principal point is at ({}, {}) px, far from the middle: give pictures of the size that the intrinsics are of",
        size_px[0],
        size_px[1],
        centre_px[0],
        centre_px[1]
    )]
    Centre {
        /// Its size.
        size_px: [u32; 2],
        /// The principal point.
        centre_px: [f64; 2],
    },
    /// A file that ends too early, or has another content.
    #[error("it ends too early at byte {0}, or is a file of another kind")]
    Cut(usize),
    /// A count that is too large for the file, or for a model.
    #[error("{0} of them do not fit into the file")]
    Count(u64),
    /// A camera that is not in the list.
    #[error("camera {0} is not in the list of cameras")]
    NoCamera(u64),
    /// Several objects, none of which was named as the toy.
    #[error("the scene has the objects {0}: name the toy with --object")]
    Objects(String),
    /// A mesh that cannot be read.
    #[error("{0}")]
    Mesh(String),
}

fn looked_for(first: &Option<String>) -> String {
    first.as_ref().map_or(String::new(), |path| {
        format!(": the first is looked for as {path:?}")
    })
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
