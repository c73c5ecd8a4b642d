//! Files that people keep.

use std::fs;
use std::io;
use std::path::Path;

use app_core::app::Saved;
use app_core::scene::Image;

/// Writes a picture as PNG into a folder, which is made where it is missing.
#[must_use]
pub fn picture(folder: &Path, name: &str, picture: &Image) -> Saved {
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    let encoded = image::ImageEncoder::write_image(
        encoder,
        &picture.rgba8,
        picture.width_px,
        picture.height_px,
        image::ExtendedColorType::Rgba8,
    );
    match encoded {
        Ok(()) => bytes(folder, name, &png),
        Err(_) => Saved::Failed,
    }
}

/// Writes a file into a folder, which is made where it is missing.
#[must_use]
pub fn bytes(folder: &Path, name: &str, bytes: &[u8]) -> Saved {
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(folder.join(name), bytes));
    match written.map_err(|error| error.kind()) {
        Ok(()) => Saved::Done,
        Err(io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded) => Saved::NoRoom,
        Err(io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem) => Saved::NotAllowed,
        Err(_) => Saved::Failed,
    }
}
