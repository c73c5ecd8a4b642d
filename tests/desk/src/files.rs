//! Read access to one folder of the file system, and to nothing outside it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use app_core::session::{FileError, Files, check_path};
use thiserror::Error;

/// The session that comes with the project.
pub const BUNDLED_SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/llama");

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

    /// Whether a folder is this one or lies in it.
    ///
    /// # Errors
    /// When it cannot be found.
    pub fn holds(&self, folder: &Path) -> io::Result<bool> {
        Ok(folder.canonicalize()?.starts_with(&self.root))
    }

    /// Paths of its files and of those in its folders, with `/` between their parts.
    ///
    /// # Errors
    /// When one is a link, which could lead out of it, has a name that is no text, or a folder cannot be read.
    pub fn paths(&self) -> anyhow::Result<Vec<String>> {
        let mut paths = Vec::new();
        let mut folders = vec![String::new()];
        while let Some(folder) = folders.pop() {
            let at = self.root.join(&folder);
            for entry in fs::read_dir(&at).with_context(|| at.display().to_string())? {
                let entry = entry?;
                let label = || entry.path().display().to_string();
                let kind = entry.file_type()?;
                ensure!(!kind.is_symlink(), "{}: is a link", label());
                let name = entry.file_name().into_string().ok().with_context(label)?;
                let path = format!("{folder}{name}");
                if kind.is_dir() {
                    folders.push(path + "/");
                } else {
                    paths.push(path);
                }
            }
        }
        paths.sort_unstable();
        Ok(paths)
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
