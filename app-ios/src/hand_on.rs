//! Files on their way out of the app: into Photos, and to whatever the share sheet offers.

use std::path::{Path, PathBuf};
use std::ptr;

use objc2::rc::Retained;
use objc2::{MainThreadMarker, MainThreadOnly};
use objc2_foundation::{NSArray, NSString, NSURL};
use objc2_ui_kit::{
    UIActivityViewController, UIApplication, UIBackgroundTaskIdentifier, UIImage,
    UISaveVideoAtPathToSavedPhotosAlbum, UIVideoAtPathIsCompatibleWithSavedPhotosAlbum, UIView,
};

/// Shows what can be done with files, over a view that is in a window.
pub(crate) fn show_sheet(view: &UIView, files: &[PathBuf]) {
    let Some(controller) = view.window().and_then(|window| window.rootViewController()) else {
        return;
    };
    let urls: Vec<Retained<NSURL>> = files
        .iter()
        .filter_map(|file| Some(NSURL::fileURLWithPath(&NSString::from_str(file.to_str()?))))
        .collect();
    if urls.is_empty() || controller.presentedViewController().is_some() {
        return;
    }
    let items = NSArray::from_retained_slice(&urls);
    // SAFETY: addresses of files are among the items that a sheet takes; an array forgets the type of what it holds.
    let sheet = unsafe {
        UIActivityViewController::initWithActivityItems_applicationActivities(
            UIActivityViewController::alloc(view.mtm()),
            items.cast_unchecked(),
            None,
        )
    };
    controller.presentViewController_animated_completion(&sheet, true, None);
}

/// Has Photos take a copy of a photo or a video, where the person lets it; the system asks them the first time.
pub(crate) fn into_photos(file: &Path) {
    let Some(path) = file.to_str().map(NSString::from_str) else {
        return;
    };
    // SAFETY: without a target nobody is told, and nothing is called with the context.
    unsafe {
        if file.extension().is_some_and(|extension| extension == "png") {
            if let Some(image) = UIImage::imageWithContentsOfFile(&path) {
                image.write_to_saved_photos_album(None, None, ptr::null_mut());
            }
        } else if UIVideoAtPathIsCompatibleWithSavedPhotosAlbum(&path) {
            UISaveVideoAtPathToSavedPhotosAlbum(&path, None, None, ptr::null_mut());
        }
    }
}

/// Lets the app run on in the background until what is returned is dropped.
pub(crate) fn keep_running() -> Box<dyn Send> {
    Box::new(MainThreadMarker::new().map(Unsuspended::begin))
}

/// A task of UIKit's, which ends when this is dropped.
struct Unsuspended {
    application: Retained<UIApplication>,
    task: UIBackgroundTaskIdentifier,
}

// SAFETY: all that another thread does with the application is to end the task, which «can be called on a non-main thread»
// (Apple, UIApplication), and to release a singleton that never goes.
unsafe impl Send for Unsuspended {}

impl Unsuspended {
    fn begin(main_thread: MainThreadMarker) -> Self {
        let application = UIApplication::sharedApplication(main_thread);
        let task = application.beginBackgroundTaskWithExpirationHandler(None);
        Self { application, task }
    }
}

impl Drop for Unsuspended {
    fn drop(&mut self) {
        self.application.endBackgroundTask(self.task);
    }
}
