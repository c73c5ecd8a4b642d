//! A toy's file on a desktop, with the files that it refers to.

use std::path::Path;

use anyhow::{Context, ensure};
use app_core::session::{Folder, toy_neighbours};
use app_core::toy::{MAX_FILE_BYTES, packed};

const MAX_BYTES: u64 = MAX_FILE_BYTES as u64;

/// The bytes of one binary glTF: those of the file, with the files that it refers to included.
///
/// # Errors
/// When it cannot be read, is too large or no glTF, or refers to a buffer that is not beside it.
pub fn read_toy(path: &Path) -> anyhow::Result<Vec<u8>> {
    let named = || path.display().to_string();
    let n_bytes = std::fs::metadata(path).with_context(named)?.len();
    ensure!(
        n_bytes <= MAX_BYTES,
        "{}: has {n_bytes} bytes; the limit is {MAX_BYTES}",
        path.display()
    );
    let bytes = std::fs::read(path).with_context(named)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = Folder::open(folder.unwrap_or(Path::new(".")))?;
    Ok(packed(&named(), &bytes, &mut toy_neighbours(&folder, ""))?.into_owned())
}
