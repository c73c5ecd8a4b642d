//! Records of the executed passes.

use serde::Serialize;

use super::work::Work;

/// The path of a pass: estimation from the real toy, or drawing of each picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PassGroup {
    /// Updates of scene state from a view.
    Capture,
    /// Rendering of every picture.
    Frame,
}

impl PassGroup {
    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Capture => "capture",
            Self::Frame => "frame",
        }
    }
}

/// An executed pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct PassRun {
    /// The path of the pass.
    pub path: PassGroup,
    /// Its name.
    pub pass: &'static str,
    /// Number of runs.
    pub n_runs: u32,
    /// The cost of all runs.
    pub work: Work,
}

/// Device time of one pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassTime {
    /// The path of the pass.
    pub path: PassGroup,
    /// The pass's name.
    pub pass: &'static str,
    /// Device time from its beginning to its end, over all its runs.
    pub gpu_ms: f64,
}
