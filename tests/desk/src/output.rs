//! Files of a result. Each is written under a temporary name beside its place and then renamed, so
//! that it exists whole or not at all.

pub mod folder;

use std::path::{Path, PathBuf};
use std::{fs, io, process};

use app_core::scene::Image;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use thiserror::Error;

/// A file or folder that cannot be written.
#[derive(Debug, Error)]
#[error("writing {}: {reason}", path.display())]
pub struct WriteError {
    /// The path to write.
    pub path: PathBuf,
    /// The reason of the failure.
    pub reason: String,
}

impl WriteError {
    fn new(path: &Path, reason: impl ToString) -> Self {
        Self {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}

/// Makes a folder and its parents if they are missing.
///
/// # Errors
/// When the system refuses, or something else has that name.
pub fn make_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|error| WriteError::new(folder, error))
}

/// Removes a file; a missing file is no error.
///
/// # Errors
/// When the system refuses.
pub fn remove_file(path: &Path) -> Result<(), WriteError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(WriteError::new(path, error)),
        _ => Ok(()),
    }
}

/// Writes a picture as PNG, alpha included.
///
/// # Errors
/// When its bytes do not fit its size, or the system refuses; an older file at `path` stays then.
pub fn write_png(path: &Path, image: &Image) -> Result<(), WriteError> {
    write_whole(path, &png_of(path, image)?)
}

/// A picture as the bytes of a PNG, alpha included, for the file `path`.
pub(crate) fn png_of(path: &Path, image: &Image) -> Result<Vec<u8>, WriteError> {
    let n_bytes = u64::from(image.width_px) * u64::from(image.height_px) * 4;
    if image.rgba8.len() as u64 != n_bytes {
        let reason = format!("the picture has {} bytes instead of {n_bytes}", image.rgba8.len());
        return Err(WriteError::new(path, reason));
    }
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(
            &image.rgba8,
            image.width_px,
            image.height_px,
            ExtendedColorType::Rgba8,
        )
        .map_err(|error| WriteError::new(path, error))?;
    Ok(png)
}

/// Writes a file.
///
/// # Errors
/// When the system refuses; an older file at `path` stays then, and no other file remains.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    // Two runs with one folder must not share a temporary file.
    name.push(format!(".{}.partial", process::id()));
    let partial = path.with_file_name(name);
    fs::write(&partial, bytes)
        .and_then(|()| fs::rename(&partial, path))
        .map_err(|error| {
            // The first error says what is wrong; another one about the remnant adds nothing.
            let _ = fs::remove_file(&partial);
            WriteError::new(path, error)
        })
}
