//! Access to a session's files: a trait for the shell, and the common rule for paths.

use thiserror::Error;

/// File name of a session's index, which marks a folder as a session.
pub const INDEX_FILE: &str = "capture.json";
/// Limit for the size of an index, in bytes.
pub const MAX_INDEX_BYTES: u64 = 16 << 20;

/// Read access to the files of one session, and to nothing else.
pub trait Files: Send + Sync {
    /// Reads a whole file.
    ///
    /// `path` is relative to the session, with `/` between its parts. An implementation calls
    /// [`check_path`] and makes sure that links do not lead out of the session.
    ///
    /// # Errors
    /// When the path is refused, or the file is missing, unreadable or larger than
    /// `max_bytes`.
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError>;
}

/// The reason why a file could not be read. The caller knows its name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FileError {
    /// The path is not one that a session may use.
    #[error("bad path: {0}")]
    Path(#[from] PathError),
    /// There is no such file.
    #[error("the file does not exist")]
    Missing,
    /// The path belongs to a folder or a device.
    #[error("not a regular file")]
    NotAFile,
    /// A link leads out of the session's folder.
    #[error("the file lies outside the session's folder")]
    Outside,
    /// The file is larger than the limit for its kind.
    #[error("larger than the {max_bytes} bytes allowed")]
    TooLarge {
        /// The limit that was passed.
        max_bytes: u64,
    },
    /// The system refused.
    #[error("cannot be read: {0}")]
    Io(String),
}

/// The reason why a path is refused, independent of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// An empty path.
    #[error("it is empty")]
    Empty,
    /// An absolute path.
    #[error("it is absolute, but must be relative to the session's folder")]
    Absolute,
    /// A path with `..`.
    #[error("it holds `..`, but must stay inside the session's folder")]
    Climbs,
    /// A character with another meaning on other systems.
    #[error("it holds {0:?}, which is not portable")]
    Character(char),
}

/// Checks that a path can only name something inside the folder it is relative to.
///
/// # Errors
/// When it is empty, absolute, climbs with `..`, or holds a backslash, a colon (drive letters and
/// streams) or a control character.
pub fn check_path(path: &str) -> Result<(), PathError> {
    if path.is_empty() {
        return Err(PathError::Empty);
    }
    if let Some(odd) = path.chars().find(|c| matches!(c, '\\' | ':') || c.is_control()) {
        return Err(PathError::Character(odd));
    }
    if path.starts_with('/') {
        return Err(PathError::Absolute);
    }
    if path.split('/').any(|part| part == "..") {
        return Err(PathError::Climbs);
    }
    Ok(())
}
