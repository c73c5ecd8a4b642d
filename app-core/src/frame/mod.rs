//! One frame in, one report out.

pub(crate) mod input;
pub(crate) mod mismatch;
pub(crate) mod no_light;
pub(crate) mod report;
pub(crate) mod warning;

pub use crate::geometry::rect::PixelRect;
pub use crate::gpu::pass_run::{PassRun, PassTime, Path};
pub use crate::gpu::stages::{Clock, StageTime};
pub use crate::gpu::work::Work;
pub use crate::plan::{Change, LeftOut};
pub use input::FrameInput;
pub use mismatch::Mismatch;
pub use no_light::NoLight;
pub use report::FrameReport;
pub use warning::{Outlier, UnseenShadow, Warning};
