//! In-between frames of key poses that were printed and photographed one by one.
//!
//! All keys are registered to one camera, one exposure, one light and one place of the toy. For
//! each frame between two keys, the core makes a picture from either photograph, and the two are
//! blended in linear light.

pub mod blend;
mod exposure;
mod film;
mod keys;
pub mod light;
mod nodes;
mod page;
mod placement;
pub mod raster;
mod report;
pub mod resample;
pub mod shot;
mod stage;
pub mod timing;
mod words;

use std::path::PathBuf;

use app_core::alignment::AlignError;
use app_core::core::CoreError;
use app_core::toy::ToyError;
use desk::output::WriteError;
use thiserror::Error;

pub use film::{Film, Options, PictureNames, make};
pub use keys::{Found, Key, Keys, PoseDifference};
pub use report::{CONTACT_FILE, REPORT_FILE, SHEET_FILE};
pub use words::findings;

/// The reason why in-between frames cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InbetweenError {
    /// The shot cannot be read.
    #[error(transparent)]
    Shot(#[from] shot::ShotError),
    /// A shot without keys.
    #[error("the shot has no key; in-between frames need two or more")]
    NoKey,
    /// A key cannot be aligned.
    #[error("aligning key {index}: {reason}")]
    Align {
        /// The key, from 0.
        index: usize,
        /// The reason.
        reason: Box<AlignError>,
    },
    /// The toy cannot be posed.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// The core refuses a key, or cannot make a frame from it.
    #[error("key {index}: {reason}")]
    Core {
        /// The key, from 0.
        index: usize,
        /// The core's error.
        reason: CoreError,
    },
    /// The film would have too many frames.
    #[error(transparent)]
    Timing(#[from] timing::TooMany),
    /// The output folder cannot be used.
    #[error("{}: {reason}", folder.display())]
    Out {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        reason: &'static str,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
