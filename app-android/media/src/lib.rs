//! Videos by Android's own encoder, copies of files for other apps, values of the display, the
//! thermal state, and output to the person beside the screen.
//!
//! `yuv`, the layout of samples that encoders take, and `stored`, where a file belongs, run in
//! desktop tests; `video`, `media_store`, `display`, `heat`, `person` and `settings` are compiled
//! for Android alone.

pub mod stored;
pub mod yuv;

#[cfg(target_os = "android")]
pub mod display;
#[cfg(target_os = "android")]
pub mod heat;
#[cfg(target_os = "android")]
pub mod media_store;
#[cfg(target_os = "android")]
pub mod person;
#[cfg(target_os = "android")]
pub mod settings;
#[cfg(target_os = "android")]
pub mod video;
