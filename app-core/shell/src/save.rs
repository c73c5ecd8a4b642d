//! Files for the person.

use std::io;
use std::path::Path;

use app_core::app::Saved;
use app_core::scene::Image;

use crate::kept;

/// Writes a picture as PNG, into a folder that is created if it is missing.
#[must_use]
pub fn picture(path: &Path, picture: &Image) -> Saved {
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
        Ok(()) => bytes(path, &png),
        Err(_) => Saved::Failed,
    }
}

/// Writes a file, completely or not at all, into a folder that is created if it is missing.
#[must_use]
pub fn bytes(path: &Path, bytes: &[u8]) -> Saved {
    let (folder, name) = (path.parent(), path.file_name());
    let folder = folder.unwrap_or(Path::new(""));
    outcome(kept::store(folder, name.unwrap_or_default(), bytes))
}

/// The message about a file that was written, or was not.
pub(crate) fn outcome(written: io::Result<()>) -> Saved {
    match written.map_err(|error| error.kind()) {
        Ok(()) => Saved::Done,
        Err(io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded) => Saved::NoRoom,
        Err(io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem) => Saved::NotAllowed,
        Err(_) => Saved::Failed,
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_photo_is_a_file_of_the_same_codes_or_is_told_as_missing() {
        let folder = std::env::temp_dir().join(format!("app-shell-photos-{}", std::process::id()));
        let photo = Image {
            width_px: 2,
            height_px: 1,
            rgba8: vec![1, 2, 3, 255, 4, 5, 6, 255],
        };
        let path = folder.join("photo.png");
        assert_eq!(picture(&path, &photo), Saved::Done);
        let read = image::open(&path).expect("a PNG file").to_rgba8();
        assert_eq!(read.into_raw(), photo.rgba8);
        // A file is not a folder.
        assert_eq!(picture(&path.join("photo.png"), &photo), Saved::Failed);
        assert_eq!(bytes(&path.join("log.txt"), b""), Saved::Failed);
        // Nor can it take a folder's place: nothing is left of what was written.
        let taken = folder.join("taken.png");
        fs::create_dir(&taken).expect("a folder");
        assert_ne!(picture(&taken, &photo), Saved::Done);
        let left = fs::read_dir(&folder).expect("a folder").count();
        assert_eq!(left, 2, "the photo and the folder");
        fs::remove_dir_all(&folder).expect("a folder");
    }
}
