//! Errors that end a replay.

use std::path::PathBuf;

use app_core::alignment::AlignError;
use app_core::camera_frame::PlaneError;
use app_core::core::CoreError;
use app_core::session::SessionError;
use thiserror::Error;

use crate::frames::NoSuchFrames;
use crate::metrics::SizeError;
use crate::output::WriteError;

/// The reason of a replay that ended early.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The session, or one of its frames, cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The core refuses the session.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// The core cannot make a frame.
    #[error("frame {index}: {reason}")]
    Frame {
        /// The frame, from 0.
        index: usize,
        /// The core's error.
        reason: CoreError,
    },
    /// A frame cannot be aligned.
    #[error("aligning frame {index}: {reason}")]
    Align {
        /// The frame, from 0.
        index: usize,
        /// The reason.
        reason: Box<AlignError>,
    },
    /// A frame cannot be converted to planes.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// A picture does not fit its truth.
    #[error("scoring frame {index}: {reason}")]
    Score {
        /// The frame, from 0.
        index: usize,
        /// The difference.
        reason: SizeError,
    },
    /// The replay ended after some frames, whose report and page are written.
    #[error("{reason}; report and page hold the {n_frames} frames before it")]
    Ended {
        /// Number of finished frames.
        n_frames: usize,
        /// The reason of the end.
        reason: Box<ReplayError>,
    },
    /// A picture or the report cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Frames that the session does not have.
    #[error(transparent)]
    NoSuchFrames(#[from] NoSuchFrames),
    /// An output folder that is a session's.
    #[error("{}: holds a session, whose camera frames would be overwritten: name another folder", folder.display())]
    OutIsSession {
        /// The folder.
        folder: PathBuf,
    },
}
