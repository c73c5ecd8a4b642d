//! Access to the bundled session on disk, for examples: the core opens no file itself.
//! To be replaced by `app_core::session::Folder` as soon as there is one.

use std::{fs, path::Path};

use app_core::session::{Capture, FileError, Files, SessionError, check_path};

/// The folder of a recorded session.
pub(crate) struct Folder;

/// Opens the session that comes with the project: a jointed wooden llama on a table, under one bulb.
pub(crate) fn bundled_session() -> Result<Capture, SessionError> {
    Capture::open(Folder)
}

impl Files for Folder {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        check_path(path)?;
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/sessions/llama"));
        let bytes = fs::read(folder.join(path)).map_err(|error| FileError::Io(error.to_string()))?;
        if bytes.len() as u64 > max_bytes {
            return Err(FileError::TooLarge { max_bytes });
        }
        Ok(bytes)
    }
}
