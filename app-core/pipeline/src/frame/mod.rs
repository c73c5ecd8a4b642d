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
    /// Times of its stages on the processor, where a clock was given.
    pub stages: Vec<StageTime>,
    /// Bytes that the processor handed to the device for it.
    pub uploaded_bytes: u64,
    /// What changed since the frame before; none when the camera frame passed through.
    pub change: Option<Change>,
    /// What did not run, and why.
    pub skipped: Vec<SkippedWork>,
    /// The work region; none when the camera frame passed through.
    pub region: Option<PixelRect>,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}
