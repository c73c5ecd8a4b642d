//! Read access to one folder of the file system, and to nothing outside it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use app_core::session::{FileError, Files, check_path};
use thiserror::Error;

/// The session that comes with the project.
pub const BUNDLED_SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/sessions/llama");

/// What makes a folder a session.
pub const SESSION_FILE: &str = "capture.json";

/// A session's folder.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Without links, so that a file inside it can be told from one outside.
    root: PathBuf,
}

/// A folder that cannot be opened.
#[derive(Debug, Error)]
#[error("{}: {reason}", folder.display())]
pub struct FolderError {
    /// The folder as it was asked for.
    pub folder: PathBuf,
    /// What the system said.
    pub reason: io::Error,
}

impl Folder {
    /// Opens a folder.
    ///
    /// # Errors
    /// When there is no such folder.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, FolderError> {
        let folder = folder.as_ref();
        let error = |reason| FolderError {
            folder: folder.to_owned(),
            reason,
        };
        let root = folder.canonicalize().map_err(error)?;
        if !root.is_dir() {
            return Err(error(io::ErrorKind::NotADirectory.into()));
        }
        Ok(Self { root })
    }
}

impl Files for Folder {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        let file = self.root.join(path).canonicalize().map_err(file_error)?;
        if !file.starts_with(&self.root) {
            return Err(FileError::Outside);
        }
        // Asked before opening: opening a pipe would wait for its other end.
        if !fs::metadata(&file).map_err(file_error)?.is_file() {
            return Err(FileError::NotAFile);
        }
        // One byte more tells a file that is too large, also when it grows meanwhile.
        let mut bytes = Vec::new();
        let mut reader = File::open(&file)
            .map_err(file_error)?
            .take(max_bytes.saturating_add(1));
        let n_bytes = reader.read_to_end(&mut bytes).map_err(file_error)?;
        if n_bytes as u64 > max_bytes {
            return Err(FileError::TooLarge { max_bytes });
        }
        Ok(bytes)
    }
}

fn file_error(error: io::Error) -> FileError {
    match error.kind() {
        io::ErrorKind::NotFound => FileError::Missing,
        _ => FileError::Io(error.to_string()),
    }
}
