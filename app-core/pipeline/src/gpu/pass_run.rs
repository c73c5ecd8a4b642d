//! Records of the passes that ran.

use serde::Serialize;

use super::work::Work;

/// The path of a pass: what learns from the real toy, or what draws each picture.
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

/// A pass that ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct PassRun {
    /// The path it ran on.
    pub path: PassGroup,
    /// Its name.
    pub pass: &'static str,
    /// How often it ran.
    pub n_runs: u32,
    /// What that costs.
    pub work: Work,
}

/// Device time of one pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassTime {
    /// The path it ran on.
    pub path: PassGroup,
    /// The pass's name.
    pub pass: &'static str,
    /// Device time from its beginning to its end, over all its runs.
    pub gpu_ms: f64,
}
