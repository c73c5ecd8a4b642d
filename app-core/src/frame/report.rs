//! What was done for a frame.

use crate::frame::warning::Warning;
use crate::geometry::rect::PixelRect;
use crate::gpu::pass_run::PassRun;
use crate::plan::LeftOut;

/// What was done for a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameReport {
    /// The passes that ran, in the order of their first runs.
    pub ran: Vec<PassRun>,
    /// What did not run, and why.
    pub skipped: Vec<LeftOut>,
    /// The rectangle that was worked on; none when the camera frame passed through.
    pub region: Option<PixelRect>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}
