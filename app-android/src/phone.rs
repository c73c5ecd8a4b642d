//! The shell's requests to the phone, except for ARCore and graphics.

use std::path::PathBuf;

use app_core::app::{Language, Permission, Thermal};
use arcore::java::JavaHost;

/// A phone: Android's own, or that of a test.
pub trait Phone: JavaHost {
    /// Whether the app may use the camera.
    fn permission(&mut self) -> Permission;
    /// Shows Android's question. The activity pauses and resumes around it.
    fn ask_for_camera(&mut self);
    /// Shows Android's settings of this app.
    fn open_settings(&mut self);
    /// Finishes the activity, as Android does if an app has no way back.
    fn leave(&mut self);
    /// The person's language.
    fn language(&self) -> Language;
    /// Announces the words to screen readers.
    fn say(&mut self, words: String);
    /// Gives one short haptic pulse.
    fn knock(&mut self);
    /// Keeps the screen on, or lets it turn off.
    fn keep_awake(&mut self, is_awake: bool);
    /// The thermal state, as an `AThermalStatus`; `None` if Android does not report it.
    fn thermal_status(&mut self) -> Option<i32>;
    /// The display's rotation, as `Surface.ROTATION_*`.
    fn rotation(&mut self) -> i32;
    /// Folder for files that a person can access, at least from a computer.
    fn folder(&self) -> Option<PathBuf>;
    /// Adds a copy of a photo or a video to the gallery.
    fn show_in_gallery(&mut self, file: PathBuf);
    /// Opens the share sheet for files, and tells whether other apps get them.
    fn share(&mut self, files: Vec<PathBuf>, tell: impl FnOnce(bool) + Send + 'static);
    /// Folder for the app's own files.
    fn own_folder(&self) -> Option<PathBuf>;
}

/// The camera's permission from Android's answers: whether it is granted, whether it was requested
/// since the launch, and `shouldShowRequestPermissionRationale`, which is true after a first
/// refusal and false after a second.
#[must_use]
pub fn permission(is_granted: bool, was_asked: bool, may_explain: bool) -> Permission {
    match (is_granted, was_asked, may_explain) {
        (true, _, _) => Permission::Granted,
        (false, false, false) => Permission::Unknown,
        (false, _, true) => Permission::Denied,
        (false, true, false) => Permission::Barred,
    }
}

/// The thermal state from an `AThermalStatus`, which has seven steps, and -1 for an error.
///
/// From "severe" on, the system's throttling is visible to the person; before, it is not.
#[must_use]
pub fn thermal(status: i32) -> Thermal {
    match status {
        ..=0 => Thermal::Nominal,
        1 | 2 => Thermal::Fair,
        3 => Thermal::Serious,
        4.. => Thermal::Critical,
    }
}
