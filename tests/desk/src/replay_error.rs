//! What keeps a replay from its end.

use std::path::PathBuf;

use app_core::alignment::AlignError;
use app_core::camera_frame::PlaneError;
use app_core::core::CoreError;
use app_core::session::SessionError;
use thiserror::Error;

use crate::frames::NoSuchFrames;
use crate::metrics::SizeError;
use crate::output::WriteError;

/// A replay that did not come to its end.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The session, or one of its frames, cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The core cannot take the session.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// The core cannot make a frame.
    #[error("frame {index}: {reason}")]
    Frame {
        /// The frame, from 0.
        index: usize,
        /// What the core said.
        reason: CoreError,
    },
    /// A frame cannot be aligned.
    #[error("aligning frame {index}: {reason}")]
    Align {
        /// The frame, from 0.
        index: usize,
        /// What is wrong with it.
        reason: Box<AlignError>,
    },
    /// A frame cannot be had as planes.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// A picture does not fit its truth.
    #[error("scoring frame {index}: {reason}")]
    Score {
        /// The frame, from 0.
        index: usize,
        /// What differs.
        reason: SizeError,
    },
    /// It ended after some frames, whose report and page are written.
    #[error("{reason}; what was made of the {n_frames} frames before it is in report and page")]
    Ended {
        /// How many frames were made.
        n_frames: usize,
        /// Why there are not more.
        reason: Box<ReplayError>,
    },
    /// A picture or the report cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Frames that the session does not have.
    #[error(transparent)]
    NoSuchFrames(#[from] NoSuchFrames),
    /// An output folder whose files are someone's photographs.
    #[error("{}: holds a session, whose camera frames would be overwritten", folder.display())]
    OutIsSession {
        /// The folder.
        folder: PathBuf,
    },
}
