//! The report of one frame.

pub(crate) mod mismatch;
pub(crate) mod report;
pub(crate) mod warning;

pub use crate::geometry::rect::PixelRect;
pub use crate::gpu::pass_run::{PassRun, PassTime, Path};
pub use crate::gpu::stages::{Clock, StageTime};
pub use crate::gpu::work::Work;
pub use crate::plan::{Change, LeftOut};
pub use mismatch::Mismatch;
pub use report::FrameReport;
pub use warning::{Outlier, UnseenShadow, Warning};
