//! Makes a film from one photograph and clips.

pub mod fine;
pub mod folder;
pub mod frame_files;
pub mod grammar;
mod moving;
pub mod outputs;
pub mod render;
pub mod run;
pub mod timeline;
