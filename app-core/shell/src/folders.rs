//! Folders and names of files.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// Folders for files; a folder can be missing, for instance if its memory card was removed.
#[derive(Clone, Debug, Default)]
pub struct Folders {
    /// Files for the person.
    pub shared: Option<PathBuf>,
    /// Toys from which a person can choose.
    pub toys: Option<PathBuf>,
    /// The app's own files.
    pub own: Option<PathBuf>,
}

impl Folders {
    /// The path, without extension, of a file for the person; `None` without a folder.
    pub(crate) fn stem(&self, what: &str, number: u128) -> Option<PathBuf> {
        let folder = self.shared.as_ref()?;
        Some(folder.join(format!("{what}_{number}")))
    }
}

/// Milliseconds since 1970: names with it increase with time. A clock that is set before 1970 gives
/// every file the same name.
pub(crate) fn unix_ms() -> u128 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.unwrap_or_default().as_millis()
}
