//! In-between frames of key poses that were printed and photographed one by one.
//!
//! All keys are brought to one camera, one exposure, one light and one place of the toy. Each frame between two of them is made from
//! the photograph of either by the core, and the two pictures are blended in linear light.

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
pub use keys::{Found, Key, Keys, Off};
pub use report::{CONTACT_FILE, REPORT_FILE, SHEET_FILE};
pub use words::findings;

/// In-between frames that cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InbetweenError {
    /// The shot cannot be read.
    #[error(transparent)]
    Shot(#[from] shot::ShotError),
    /// A shot without keys.
    #[error("the shot has no key")]
    NoKey,
    /// A key cannot be aligned.
    #[error("aligning key {index}: {reason}")]
    Align {
        /// The key, from 0.
        index: usize,
        /// What is wrong with it.
        reason: Box<AlignError>,
    },
    /// The toy cannot be posed.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// The core cannot take a key, or make a frame of it.
    #[error("key {index}: {reason}")]
    Core {
        /// The key, from 0.
        index: usize,
        /// What the core said.
        reason: CoreError,
    },
    /// Too many frames.
    #[error(transparent)]
    Timing(#[from] timing::TooMany),
    /// A folder that is not to be written into.
    #[error("{}: {reason}", folder.display())]
    Out {
        /// The folder.
        folder: PathBuf,
        /// Why not.
        reason: &'static str,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
