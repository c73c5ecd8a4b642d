//! The history of starts, in a file of the app's own.

use std::io;
use std::path::Path;

use app_core::app::LaunchHistory;

use crate::kept;

/// Name of the file.
const FILE: &str = "starts.txt";

/// Reads the stored history, and stores that another start begins. If it cannot be stored, the
/// history is empty. In a package for engineers nothing counts: see
/// [`LaunchHistory::for_engineers`].
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

/// Stores the history, completely or not at all, in a folder that is created if it is missing.
///
/// # Errors
/// If the file cannot be written.
pub fn store(folder: &Path, text: &str) -> io::Result<()> {
    kept::store(folder, FILE, text.as_bytes())
}
