//! The iPhone shell: one window scene with one Metal view, and a camera, for the app that both phones share.
//!
//! It translates and decides nothing. UIKit calls `scene` and `view`, ARKit a delegate in the `arkit` package; what they tell waits
//! in `inbox` for the `shell`, which hands it to the one `app_core::live::Live` on the `stage` with each picture, and does what
//! that then asks for: by `arkit`, `ios_media`, and the worker of `app_shell` for files and threads.
//! `convert` knows UIKit's points and the system's numbers, `arkit::convert` ARKit's axes and pixel rules; the core knows none.
//!
//! What is there: the app on the view's layer, with a toy to begin with; touches, safe area and letter size; the camera's
//! permission; world tracking with level planes, interruptions and one anchor; exposure, white balance and focus held;
//! the card, and the dark picture of its lens; alignments on a thread; photos and videos, which Photos takes as well; recordings,
//! times and the log as files that Files shows, and by the share sheet; heat, memory and free space.
//! What is not: words for those who do not see the screen. 30 frames a second slow the pictures rather than the camera.
//! Nothing of this has run on a phone.
//!
//! The crate is a static library with one C function, `app_ios_main`. It builds on any system, because only linking
//! needs Apple's SDK; `README.md` beside this crate tells how a Mac makes an app of it.
//! On other systems only what is free of Apple's is compiled.

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
