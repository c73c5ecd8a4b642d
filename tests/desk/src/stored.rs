//! A session's storage: a folder or a recording.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use app_core::recording::{Loss, Recording, RecordingError, Source};
use app_core::session::{FileError, Files};
use thiserror::Error;

use crate::files::{Folder, FolderError};

/// A session's files.
pub enum Stored {
    /// The files of a folder.
    Folder(Folder),
    /// The files of a recording.
    Recording(Box<Recording>),
}

/// A session that cannot be opened.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StoredError {
    /// There is no such folder or file.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The file is no recording, or nothing of it can be read.
    #[error("{}: {reason}", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: RecordingError,
    },
}

impl Stored {
    /// Opens a folder, or a file as a recording.
    ///
    /// # Errors
    /// When the path does not exist, or nothing of the recording can be read.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, StoredError> {
        let path = path.as_ref();
        if !path.is_file() {
            return Ok(Self::Folder(Folder::open(path)?));
        }
        let error = |reason| StoredError::Recording {
            path: path.to_owned(),
            reason,
        };
        let file = OpenFile::open(path).map_err(|reason| error(RecordingError::Io(reason.to_string())))?;
        Ok(Self::Recording(Box::new(Recording::open(file).map_err(error)?)))
    }

    /// Paths of all its files, relative to the session.
    ///
    /// # Errors
    /// When a folder of it cannot be read, or has a link in it.
    pub fn paths(&self) -> anyhow::Result<Vec<String>> {
        match self {
            Self::Folder(folder) => Ok(folder.paths()?),
            Self::Recording(recording) => Ok(recording.paths().into_iter().map(str::to_owned).collect()),
        }
    }

    /// The losses of a damaged recording.
    #[must_use]
    pub fn losses(&self) -> &[Loss] {
        match self {
            Self::Folder(_) => &[],
            Self::Recording(recording) => recording.losses(),
        }
    }
}

impl Files for Stored {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        match self {
            Self::Folder(folder) => folder.read(path, max_bytes),
            Self::Recording(recording) => recording.read(path, max_bytes),
        }
    }
}

/// A file that is read at any offset.
struct OpenFile {
    file: Mutex<File>,
    n_bytes: u64,
}

impl OpenFile {
    fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        Ok(Self {
            n_bytes: file.metadata()?.len(),
            file: Mutex::new(file),
        })
    }
}

impl Source for OpenFile {
    fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<()> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(into)
    }
}
