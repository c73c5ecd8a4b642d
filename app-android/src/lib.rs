//! The Android shell: a native activity over the app that both phones share,
//! `app_core::live::Live`.
//!
//! `shell` passes events to the app and executes its requests: by the `arcore` package its camera,
//! by the worker of `app_shell`, and by `phone` everything else; `input` converts Android's touches
//! and screen, and `app_shell::pace` decides when a picture is drawn. All of these run in desktop
//! tests, with a fake of ARCore's library and of the phone. Only on Android are compiled:
//! `lifecycle`, the activity's event loop; `stage`, which lends the app the activity's window;
//! `java`, the camera's permission and the system's settings through JNI. Videos are encoded, and
//! files copied to places where other apps find them, by the `android_media` package.
//!
//! None of this has run on a phone. TalkBack says the words of each step; not implemented: buttons
//! that it finds. Recordings are JPEG pictures by this project's own code: Android's encoders make video
//! streams, which no program on the desktop reads without a C library. Photos, videos, recordings,
//! the log and times are written into the app's own folder, from which the gallery and the
//! receivers of shared files get copies; toys of the person's own are read from there. ARCore
//! controls exposure, white balance and focus itself, so none of them is held, and no lens is
//! photographed.
//!
//! No state is kept in statics: Android may destroy the activity and run [`android_main`] again in
//! the same process.
//!
//! [`android_main`]: https://docs.rs/android-activity/0.6/android_activity/#main-thread-entrypoint-android_main

pub mod input;
pub mod phone;
pub mod shell;

#[cfg(target_os = "android")]
mod java;
#[cfg(target_os = "android")]
mod lifecycle;
#[cfg(target_os = "android")]
mod stage;

#[cfg(test)]
mod tests;

/// Called by the activity glue on a thread of its own, once per created activity.
///
/// Returning closes the activity. Panics end in `guard`; the glue would also catch a panic of this
/// function, write it to the log and close the activity, so none reaches Java. Standard error ends
/// up in the log.
#[cfg(target_os = "android")]
// SAFETY: the only definition of this symbol, with the signature that the glue declares.
#[unsafe(no_mangle)]
fn android_main(app: android_activity::AndroidApp) {
    if let Err(error) = lifecycle::run(&app) {
        eprintln!("app-android: closing the activity: {error}");
        java::say(&app, error.words(java::language(&app)));
    }
}
