//! Read access to one folder of the file system, and to nothing outside it. The only file of the core that opens another,
//! and only with the feature `fs`.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::files::{FileError, Files, check_path};

/// A session's folder: reads its files and no others, whatever its paths and links are.
///
/// Only with the feature `fs`.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Absolute path without links, to recognise files outside of it.
    root: PathBuf,
}

/// A folder that cannot be opened or listed.
#[derive(Debug, Error)]
#[error("{}: {reason}", path.display())]
pub struct FolderError {
    /// The folder, or an entry of it.
    pub path: PathBuf,
    /// The system's error, or another reason.
    pub reason: io::Error,
}

impl Folder {
    /// Opens a folder.
    ///
    /// # Errors
    /// When there is no such folder.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, FolderError> {
        let folder = folder.as_ref();
        let error = FolderError::at(folder);
        let root = folder.canonicalize().map_err(&error)?;
        if root.is_dir() {
            Ok(Self { root })
        } else {
            Err(error(io::ErrorKind::NotADirectory.into()))
        }
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
    /// When one is a link, which could lead out of it, has a name that is not valid text, or a folder
    /// cannot be read.
    pub fn paths(&self) -> Result<Vec<String>, FolderError> {
        let mut paths = Vec::new();
        let mut folders = vec![String::new()];
        while let Some(folder) = folders.pop() {
            let at = self.root.join(&folder);
            for entry in fs::read_dir(&at).map_err(FolderError::at(&at))? {
                let entry = entry.map_err(FolderError::at(&at))?;
                let path = entry.path();
                let error = FolderError::at(&path);
                let kind = entry.file_type().map_err(&error)?;
                if kind.is_symlink() {
                    return Err(error(io::Error::other("is a link")));
                }
                let name = entry.file_name().into_string();
                let name = name.map_err(|_| error(io::Error::other("its name is not valid text")))?;
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

impl FolderError {
    fn at(path: &Path) -> impl Fn(io::Error) -> Self {
        move |reason| Self {
            path: path.to_owned(),
            reason,
        }
    }
}

impl Files for Folder {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        let file = self.root.join(path).canonicalize().map_err(file_error)?;
        if !file.starts_with(&self.root) {
            return Err(FileError::Outside);
        }
        // Checked before opening: opening a pipe would wait for its other end.
        if !fs::metadata(&file).map_err(file_error)?.is_file() {
            return Err(FileError::NotAFile);
        }
        // One byte more reveals a file that is too large, even if it grows meanwhile.
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
