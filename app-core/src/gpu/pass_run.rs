//! What is told of passes that ran.

/// Which of the two paths a pass belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Path {
    /// What is learned of a place or a view of it.
    Capture,
    /// What is made for every picture.
    Frame,
}

impl Path {
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PassRun {
    /// The path it ran on.
    pub path: Path,
    /// Its name.
    pub pass: &'static str,
    /// How often it ran.
    pub n_runs: u32,
}

/// Device time of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// The path it ran on.
    pub path: Path,
    /// The pass's name.
    pub pass: &'static str,
    /// Device time from its beginning to its end, over all its runs.
    pub gpu_ms: f64,
}
