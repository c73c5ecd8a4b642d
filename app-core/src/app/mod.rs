//! The logic of the app that both phones and the desktop share: no platform, no clock, no files.

mod pose_filter;

pub use pose_filter::{PoseFilter, PoseNoise, PoseStep};
