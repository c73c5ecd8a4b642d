//! What the shell asks of the phone beside ARCore and graphics.

use std::path::{Path, PathBuf};

use app_core::app::{Permission, Thermal};
use arcore::java::JavaHost;

/// A phone: Android's own, or a test's.
pub trait Phone: JavaHost {
    /// Whether the app may use the camera.
    fn permission(&mut self) -> Permission;
    /// Shows Android's question. The activity pauses and resumes around it.
    fn ask_for_camera(&mut self);
    /// Shows Android's settings of this app.
    fn open_settings(&mut self);
    /// Keeps the screen on, or lets it go off.
    fn keep_awake(&mut self, is_awake: bool);
    /// How hot the phone is, as an `AThermalStatus`; none where Android does not tell.
    fn thermal_status(&mut self) -> Option<i32>;
    /// Where files go that people get at, with a computer at least.
    fn folder(&self) -> Option<PathBuf>;
    /// Has the gallery show a copy of a photo or a video.
    fn show_in_gallery(&mut self, file: PathBuf);
    /// Asks the person what to do with files.
    fn share(&mut self, files: Vec<PathBuf>);
    /// Where files go that are the app's own.
    fn own_folder(&self) -> Option<PathBuf>;
}

/// The camera's permission by what Android says: whether it is granted, whether it was asked for since the app was started,
/// and whether `shouldShowRequestPermissionRationale`, which is so after a first refusal and no longer after a second.
#[must_use]
pub fn permission(is_granted: bool, was_asked: bool, may_explain: bool) -> Permission {
    match (is_granted, was_asked, may_explain) {
        (true, _, _) => Permission::Granted,
        (false, false, false) => Permission::Unknown,
        (false, _, true) => Permission::Denied,
        (false, true, false) => Permission::Barred,
    }
}

/// How hot the phone is from an `AThermalStatus`, which has seven steps, -1 for an error.
///
/// From "severe" on the system slows down what a person sees; before that only what no one notices.
#[must_use]
pub fn thermal(status: i32) -> Thermal {
    match status {
        ..=0 => Thermal::Nominal,
        1 | 2 => Thermal::Fair,
        3 => Thermal::Serious,
        4.. => Thermal::Critical,
    }
}

/// How Android's media store knows a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    /// MIME type.
    pub mime: &'static str,
    /// The store's table: the inner class of `android.provider.MediaStore`, as Java's byte code names it.
    pub table: &'static str,
    /// Folder of the phone's storage: each table has its own.
    pub folder: &'static str,
}

/// By the name's extension. What is no photo and no video is a download.
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
