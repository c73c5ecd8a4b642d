//! A file's entry in Android's media store.

use std::path::Path;

/// A file's entry in Android's media store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    /// MIME type.
    pub mime: &'static str,
    /// The store's table: the inner class of `android.provider.MediaStore`, as Java's byte code names it.
    pub table: &'static str,
    /// Folder of the phone's storage: each table has its own.
    pub folder: &'static str,
}

/// Chosen by the name's extension. A file that is neither a photo nor a video is a download.
#[must_use]
pub fn stored(file: &Path) -> Stored {
    const PHOTO: [&str; 2] = [
        "android/provider/MediaStore$Images$Media",
        "Pictures/Shadow Retargeting",
    ];
    const VIDEO: [&str; 2] = [
        "android/provider/MediaStore$Video$Media",
        "Movies/Shadow Retargeting",
    ];
    const OTHER: [&str; 2] = [
        "android/provider/MediaStore$Downloads",
        "Download/Shadow Retargeting",
    ];
    let extension = file.extension().and_then(|extension| extension.to_str());
    let (mime, [table, folder]) = match extension.unwrap_or_default() {
        "png" => ("image/png", PHOTO),
        "mp4" => ("video/mp4", VIDEO),
        "avi" => ("video/x-msvideo", VIDEO),
        "txt" => ("text/plain", OTHER),
        "json" => ("application/json", OTHER),
        _ => ("application/octet-stream", OTHER),
    };
    Stored { mime, table, folder }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photos_and_videos_go_to_the_gallery_and_all_else_to_downloads() {
        let cases = [
            ("a.png", "image/png", "Images$Media", "Pictures/"),
            ("a.mp4", "video/mp4", "Video$Media", "Movies/"),
            ("a.avi", "video/x-msvideo", "Video$Media", "Movies/"),
            ("log.txt", "text/plain", "Downloads", "Download/"),
            ("profile.json", "application/json", "Downloads", "Download/"),
            ("a.mcap", "application/octet-stream", "Downloads", "Download/"),
            ("a", "application/octet-stream", "Downloads", "Download/"),
        ];
        for (file, mime, table, folder) in cases {
            let stored = stored(Path::new(file));
            assert_eq!(stored.mime, mime);
            assert!(
                stored.table.ends_with(table) && stored.folder.starts_with(folder),
                "{file}: {stored:?}"
            );
        }
    }
}
