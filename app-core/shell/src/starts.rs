//! What is kept from start to start, in a file of the app's own.

use std::path::Path;
use std::{fs, io};

use app_core::app::LaunchHistory;

/// Its name.
const FILE: &str = "starts.txt";

/// Reads what was kept, and stores that another start begins. What cannot be stored is as if nothing was kept.
#[must_use]
pub fn begin(folder: &Path) -> LaunchHistory {
    let mut history = LaunchHistory::read(&fs::read_to_string(folder.join(FILE)).unwrap_or_default());
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
    fs::create_dir_all(folder)?;
    let whole = folder.join("starts.new");
    fs::write(&whole, text)?;
    fs::rename(whole, folder.join(FILE))
}
