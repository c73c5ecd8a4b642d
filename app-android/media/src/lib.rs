//! Videos by Android's own encoder, and copies of files where other apps find them.
//!
//! `yuv`, the layout of samples that encoders take, and `stored`, where a file belongs, run in desktop tests; `video` and `media_store`
//! are compiled for Android alone.

pub mod stored;
pub mod yuv;

#[cfg(target_os = "android")]
pub mod media_store;
#[cfg(target_os = "android")]
pub mod video;
