//! What the shell asks of the phone beside ARCore and graphics.

use std::ffi::c_void;
use std::path::PathBuf;

use app_core::app::Permission;

/// Two pointers of Java: the environment of this thread, and the activity.
#[derive(Clone, Copy, Debug)]
pub struct Java {
    /// `JNIEnv *`.
    pub env: *mut c_void,
    /// `jobject` of the activity.
    pub activity: *mut c_void,
}

/// A phone: Android's own, or a test's.
pub trait Phone {
    /// The pointers that ARCore is called with, valid on this thread until the next call.
    fn java(&mut self) -> Java;
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
