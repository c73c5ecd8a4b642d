//! Pictures as Apple's pixel buffers, and the phone's own encoders: `jpeg` for recordings, `video`
//! for videos.

#[cfg(target_os = "ios")]
pub mod jpeg;
#[cfg(target_os = "ios")]
pub mod pixels;
#[cfg(target_os = "ios")]
pub mod video;

pub mod order;
