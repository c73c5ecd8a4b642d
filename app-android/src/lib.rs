//! The Android shell: a native activity that lends the shared core a window.
//!
//! Data flows one way: Android's life cycle events reach [`android_main`]'s loop in `lifecycle`, which hands
//! windows to the `stage`, which keeps the one `app_core::Core`.
//! `convert` holds everything that knows ARCore's axes and pixel rules; the core knows none of them.
//! `arcore` follows a session of ARCore from its installation to its frames, over a table of its functions.
//!
//! What works: the core is created on the first window, its surface follows the window, device and pipelines outlive
//! the window, and a frame is presented per display refresh.
//! What is not here yet: anything that starts `arcore`. It is tested with a fake of ARCore's library, its calls to Java are
//! missing, and no camera image, pose, plane or light reaches the core, so the screen shows what the core presents before
//! its first camera frame.
//!
//! Nothing is kept in statics: Android may destroy the activity and run [`android_main`] again in the same process.
//! On other systems only `arcore` and `convert` are compiled.
//!
//! [`android_main`]: https://docs.rs/android-activity/0.6/android_activity/#main-thread-entrypoint-android_main

pub mod arcore;
pub mod convert;

#[cfg(target_os = "android")]
mod lifecycle;
#[cfg(target_os = "android")]
mod stage;

/// Called by the activity glue on a thread of its own, once per created activity.
///
/// Returning closes the activity. The glue catches a panic of this function, writes it to the log and closes the
/// activity too, so no panic reaches Java; standard error ends up in the log as well.
#[cfg(target_os = "android")]
// SAFETY: the only definition of this symbol, with the signature that the glue declares.
#[unsafe(no_mangle)]
fn android_main(app: android_activity::AndroidApp) {
    if let Err(error) = lifecycle::run(&app) {
        eprintln!("app-android: closing the activity: {error}");
    }
}
