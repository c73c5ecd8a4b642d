//! Small files of the app's own, kept from start to start: whole or not at all.

use std::path::Path;
use std::{fs, io};

/// What a file says; none if there is none, or it is no text.
#[must_use]
pub fn text(folder: &Path, name: &str) -> Option<String> {
    fs::read_to_string(folder.join(name)).ok()
}

/// Keeps bytes, in a folder that is made if it is missing.
///
/// # Errors
/// When the file cannot be written.
pub fn store(folder: &Path, name: &str, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let whole = folder.join(name).with_extension("new");
    fs::write(&whole, bytes)?;
    fs::rename(whole, folder.join(name))
}

/// The same; if it fails it is said, and nothing is kept.
pub fn store_or_say(folder: &Path, name: &str, bytes: &[u8]) {
    if let Err(error) = store(folder, name, bytes) {
        eprintln!("{name} is not kept: {error}");
    }
}
