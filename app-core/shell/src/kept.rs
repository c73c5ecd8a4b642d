//! Small files of the app's own that are stored between starts, each completely or not at all.

use std::path::Path;
use std::{fs, io};

/// Text of a file; `None` if the file does not exist, or is not text.
#[must_use]
pub fn text(folder: &Path, name: &str) -> Option<String> {
    fs::read_to_string(folder.join(name)).ok()
}

/// Stores bytes, in a folder that is created if it is missing.
///
/// # Errors
/// If the file cannot be written.
pub fn store(folder: &Path, name: &str, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let whole = folder.join(name).with_extension("new");
    fs::write(&whole, bytes)?;
    fs::rename(whole, folder.join(name))
}

/// The same; a failure is reported on standard error, and nothing is stored.
pub fn store_or_say(folder: &Path, name: &str, bytes: &[u8]) {
    if let Err(error) = store(folder, name, bytes) {
        eprintln!("{name} is not kept: {error}");
    }
}
