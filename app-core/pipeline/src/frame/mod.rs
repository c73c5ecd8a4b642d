//! The report of one frame.

pub(crate) mod warning;

use serde::Serialize;

pub use crate::geometry::rect::PixelRect;
pub use crate::gpu::pass_run::{PassGroup, PassRun, PassTime};
pub use crate::gpu::stages::{Clock, StageTime};
pub use crate::gpu::work::Work;
pub use crate::plan::{Change, SkippedWork};
pub use warning::{Mismatch, Outlier, Thing, UnseenShadow, Warning};

/// The report of one frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct FrameReport {
    /// The passes that ran, in the order of their first runs.
    pub ran: Vec<PassRun>,
    /// Times of the stages on the processor, if a clock was given.
    pub stages: Vec<StageTime>,
    /// Bytes that the processor transferred to the device for the frame.
    pub uploaded_bytes: u64,
    /// Changes since the previous frame; `None` if the camera frame passed through.
    pub change: Option<Change>,
    /// The skipped work, with the reasons.
    pub skipped: Vec<SkippedWork>,
    /// The work region; `None` if the camera frame passed through.
    pub region: Option<PixelRect>,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}
