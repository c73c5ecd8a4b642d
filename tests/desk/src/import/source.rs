//! A recording's files: a folder, or a ZIP archive such as Record3D's `.r3d`.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use super::error::ImportReason;
use anyhow::Context;
use app_core::session::{FileError, Files, Folder, check_path};
use zip::ZipArchive;
use zip::result::ZipError;

/// The files of a recording.
pub enum Source {
    /// A folder.
    Folder(Folder),
    /// An archive.
    Archive(Archive),
}

/// A ZIP archive on disk.
pub struct Archive {
    zip: Mutex<ZipArchive<File>>,
    paths: Vec<String>,
}

impl Source {
    /// Opens a folder or an archive.
    ///
    /// # Errors
    /// When there is neither, or it cannot be read.
    pub fn open(path: &Path) -> anyhow::Result<Self> {
        if path.is_file() {
            let archive = Archive::open(path).with_context(|| path.display().to_string())?;
            return Ok(Self::Archive(archive));
        }
        Ok(Self::Folder(Folder::open(path)?))
    }

    /// Paths of its files.
    ///
    /// # Errors
    /// When a folder cannot be listed, as [`Folder::paths`].
    pub fn paths(&self) -> anyhow::Result<Vec<String>> {
        Ok(match self {
            Self::Folder(folder) => folder.paths()?,
            Self::Archive(archive) => archive.paths.clone(),
        })
    }

    /// Whether a folder lies in it.
    ///
    /// # Errors
    /// When it cannot be found.
    pub(super) fn holds(&self, folder: &Path) -> std::io::Result<bool> {
        match self {
            Self::Folder(of_recording) => of_recording.holds(folder),
            Self::Archive(_) => Ok(false),
        }
    }
}

impl Archive {
    fn open(path: &Path) -> anyhow::Result<Self> {
        let zip = ZipArchive::new(File::open(path)?).map_err(|error| match error {
            ZipError::InvalidArchive(_) => ImportReason::NotAnArchive.into(),
            error => anyhow::Error::from(error),
        })?;
        // Names that a session may not use are left out: nothing is written to them.
        let names = zip.file_names().collect::<Result<Vec<_>, _>>()?;
        let is_file = |name: &str| check_path(name).is_ok() && !name.ends_with('/');
        let mut paths: Vec<String> = names
            .into_iter()
            .filter(|name| is_file(name))
            .map(Cow::into_owned)
            .collect();
        paths.sort_unstable();
        Ok(Self {
            zip: Mutex::new(zip),
            paths,
        })
    }
}

impl Files for Source {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        match self {
            Self::Folder(folder) => folder.read(path, max_bytes),
            Self::Archive(archive) => archive.read(path, max_bytes),
        }
    }
}

impl Files for Archive {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        let mut zip = self.zip.lock().unwrap_or_else(PoisonError::into_inner);
        let file = zip.by_name(path).map_err(|error| match error {
            ZipError::FileNotFound => FileError::Missing,
            error => FileError::Io(error.to_string()),
        })?;
        // One byte more shows a file that is too large, whatever its header states.
        let mut bytes = Vec::new();
        let mut reader = file.take(max_bytes.saturating_add(1));
        let n_bytes = reader
            .read_to_end(&mut bytes)
            .map_err(|error| FileError::Io(error.to_string()))?;
        if n_bytes as u64 > max_bytes {
            return Err(FileError::TooLarge { max_bytes });
        }
        Ok(bytes)
    }
}
