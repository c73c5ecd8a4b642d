//! Files that are stored completely or not at all, such as those that the app keeps between starts.

use std::ffi::OsStr;
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
pub fn store(folder: &Path, name: impl AsRef<OsStr>, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let path = folder.join(name.as_ref());
    let whole = path.with_extension("new");
    let stored = fs::write(&whole, bytes).and_then(|()| fs::rename(&whole, &path));
    if stored.is_err() {
        // A part of it, if the device is full: the first reason is the one to report.
        let _ = fs::remove_file(&whole);
    }
    stored
}

/// The same; a failure is reported on standard error, and nothing is stored.
pub fn store_or_say(folder: &Path, name: &str, bytes: &[u8]) {
    if let Err(error) = store(folder, name, bytes) {
        eprintln!("{name} is not kept: {error}");
    }
}
