//! Videos by Android's own encoder. `yuv`, the layout of samples that encoders take, runs in desktop tests; `video` is compiled for
//! Android alone.

pub mod yuv;

#[cfg(target_os = "android")]
pub mod video;
