//! What is kept from start to start, in a file of the app's own.

use std::io;
use std::path::Path;

use app_core::app::LaunchHistory;

use crate::kept;

/// Its name.
const FILE: &str = "starts.txt";

/// Reads what was kept, and stores that another start begins. What cannot be stored is as if nothing was kept. In a package for
/// engineers nothing counts: see [`LaunchHistory::for_engineers`].
#[must_use]
pub fn begin(folder: &Path, is_for_engineers: bool) -> LaunchHistory {
    let mut history = LaunchHistory::read(&kept::text(folder, FILE).unwrap_or_default());
    if is_for_engineers {
        history = history.for_engineers();
    }
    history.begin();
    if let Err(error) = store(folder, &history.text()) {
        eprintln!("the start is not kept: {error}");
    }
    history
}

/// Keeps it, whole or not at all, in a folder that is made if it is missing.
///
/// # Errors
/// When the file cannot be written.
pub fn store(folder: &Path, text: &str) -> io::Result<()> {
    kept::store(folder, FILE, text.as_bytes())
}
