//! The common part of the shells for both phones and a desktop: files, worker threads, and the
//! guard at the border to the platform.
//!
//! The core does no input and output of its own; each shell would have to implement these again.
//! The caller supplies the folders.

#![forbid(unsafe_code)]

mod avi;
mod encoder;
pub mod folders;
mod gallery;
pub mod guard;
pub mod kept;
pub mod losses;
mod motion_jpeg;
pub mod pace;
pub mod pipelines;
pub mod record;
pub mod save;
pub mod starts;
pub mod toys;
pub mod video;
pub mod worker;
