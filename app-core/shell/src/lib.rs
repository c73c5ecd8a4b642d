//! What the shells of both phones and of a desktop share: files, the threads that do the work, and the guard at the border to the platform.
//!
//! The core does no input and output of its own; this is what each shell would else do again. Whoever calls brings the folders.

#![forbid(unsafe_code)]

mod avi;
mod encoder;
pub mod folders;
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
