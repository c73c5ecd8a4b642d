//! The bundled session, and the readers of others.

pub use app_core::session::{Folder, FolderError, INDEX_FILE as SESSION_FILE};

/// The bundled session.
pub const BUNDLED_SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/llama");
