//! What the shell asks of the phone beside ARCore and graphics.

use std::path::PathBuf;

use app_core::app::{Language, Permission, Thermal};
use arcore::java::JavaHost;

/// A phone: Android's own, or a test's.
pub trait Phone: JavaHost {
    /// Whether the app may use the camera.
    fn permission(&mut self) -> Permission;
    /// Shows Android's question. The activity pauses and resumes around it.
    fn ask_for_camera(&mut self);
    /// Shows Android's settings of this app.
    fn open_settings(&mut self);
    /// Finishes the activity, as Android does where an app knows of no way back.
    fn leave(&mut self);
    /// What the person reads.
    fn language(&self) -> Language;
    /// Says it to those who do not see the screen.
    fn say(&mut self, words: String);
    /// One short knock.
    fn knock(&mut self);
    /// Keeps the screen on, or lets it go off.
    fn keep_awake(&mut self, is_awake: bool);
    /// How hot the phone is, as an `AThermalStatus`; none where Android does not tell.
    fn thermal_status(&mut self) -> Option<i32>;
    /// How the display is turned, as `Surface.ROTATION_*`.
    fn rotation(&mut self) -> i32;
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
