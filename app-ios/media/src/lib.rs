//! Pictures as Apple's pixel buffers, and the phone's own encoders: `jpeg` for recordings, `video`
//! for videos; `voice_over`, which reads the interface; and `message`, for when nothing is drawn.

#[cfg(target_os = "ios")]
pub mod jpeg;
#[cfg(target_os = "ios")]
pub mod message;
#[cfg(target_os = "ios")]
pub mod pixels;
#[cfg(target_os = "ios")]
pub mod video;
#[cfg(target_os = "ios")]
pub mod voice_over;

pub mod order;
