//! The logic of the app that both phones and the desktop share: no platform, no clock, no files.

mod plate_taker;
mod pose_filter;

pub use plate_taker::{PlateRefusal, PlateShot, PlateStep, PlateTaker};
pub use pose_filter::{PoseFilter, PoseNoise, PoseStep};
