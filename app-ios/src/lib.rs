//! The iPhone shell of the app that both phones share: a window scene, a Metal view and a camera.
//!
//! It translates and decides nothing. UIKit calls `scene` and `view`, ARKit a delegate in `arkit`;
//! their events wait in `inbox` for the `shell`, which gives them to the `app_core::live::Live` on
//! the `stage` with each picture, and executes its commands by `arkit`, `ios_media`, and the worker
//! of `app_shell` for files and threads. `convert` knows UIKit's points and the system's numbers,
//! `arkit::convert` ARKit's axes and pixel rules; the core knows neither.
//!
//! It has touches, VoiceOver, safe area and letter size; the camera's permission and locked exposure; world
//! tracking with level planes, interruptions and one anchor; the card and its lens; alignments on a
//! thread; photos and videos, also in Photos; recordings, times and the log in Files and the share
//! sheet; heat, memory and free space. A rate of 30 pictures per second does not slow the camera.
//! Nothing of this has run on a phone.
//!
//! The crate is a static library with one C function, `app_ios_main`. It builds on any system: only
//! linking needs Apple's SDK. `README.md` beside this crate explains how a Mac builds the app.
//! Other systems compile only the code without Apple's frameworks.

pub mod convert;
pub mod inbox;

#[cfg(target_os = "ios")]
mod hand_on;
#[cfg(target_os = "ios")]
mod person;
#[cfg(target_os = "ios")]
mod scene;
#[cfg(target_os = "ios")]
mod shell;
#[cfg(target_os = "ios")]
mod stage;
#[cfg(target_os = "ios")]
mod view;

/// Starts UIKit with this app's delegate; the app's `main` calls it first and once, on the main thread.
///
/// Never returns: UIKit ends the process.
#[cfg(target_os = "ios")]
// SAFETY: no other definition of this symbol is linked, and `main.c` declares it with this signature.
#[unsafe(no_mangle)]
pub extern "C" fn app_ios_main() -> ! {
    scene::run_app()
}

#[cfg(test)]
mod tests;
