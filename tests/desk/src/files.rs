//! The session that comes with the project, and what reads others.

pub use app_core::session::{Folder, FolderError, INDEX_FILE as SESSION_FILE};

/// The session that comes with the project.
pub const BUNDLED_SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/llama");
