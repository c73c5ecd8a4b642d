//! Files that leave the app: to Photos, and to the targets of the share sheet.

use std::path::{Path, PathBuf};
use std::ptr;

use objc2::rc::Retained;
use objc2::{MainThreadMarker, MainThreadOnly};
use objc2_foundation::{NSArray, NSString, NSURL};
use objc2_ui_kit::{
    UIActivityViewController, UIApplication, UIBackgroundTaskIdentifier, UIImage,
    UISaveVideoAtPathToSavedPhotosAlbum, UIVideoAtPathIsCompatibleWithSavedPhotosAlbum, UIView,
};

/// Shows the share sheet for files, over a view that is in a window.
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
    // SAFETY: addresses of files are among the items of a share sheet; an array does not record the
    // type of its elements.
    let sheet = unsafe {
        UIActivityViewController::initWithActivityItems_applicationActivities(
            UIActivityViewController::alloc(view.mtm()),
            items.cast_unchecked(),
            None,
        )
    };
    controller.presentViewController_animated_completion(&sheet, true, None);
}

/// Makes Photos take a copy of a photo or a video, if the person permits it; the system asks them
/// the first time.
pub(crate) fn into_photos(file: &Path) {
    let Some(path) = file.to_str().map(NSString::from_str) else {
        return;
    };
    // SAFETY: without a target there is no callback, and the context is not used.
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

/// Keeps the app running in the background until the returned value is dropped.
pub(crate) fn keep_running() -> Box<dyn Send> {
    Box::new(MainThreadMarker::new().map(Unsuspended::begin))
}

/// A task of UIKit's, which ends when this is dropped.
struct Unsuspended {
    application: Retained<UIApplication>,
    task: UIBackgroundTaskIdentifier,
}

// SAFETY: the only actions of another thread on the application are to end the task, which «can be
// called on a non-main thread» (Apple, UIApplication), and to release a singleton that is never
// destroyed.
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
