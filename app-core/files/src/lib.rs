//! Files of an app on a phone, the same on both: recordings, photos, videos, toys, what is kept from start to start, and the
//! threads that do the work.
//!
//! The core does no input and output of its own; this is what both shells would else do twice. Whoever calls brings the folders.

#![forbid(unsafe_code)]

mod avi;
mod motion_jpeg;
pub mod record;
pub mod save;
pub mod starts;
pub mod toys;
pub mod video;
pub mod worker;
