//! The scan of a toy, by which ARKit recognises it: an `.arobject`, which an app of Apple's writes
//! while a phone moves around the toy.

use std::path::Path;

use objc2::AnyThread;
use objc2::rc::Retained;
use objc2_ar_kit::ARReferenceObject;
use objc2_foundation::{NSString, NSURL};

/// The scan in the file; `None` if it is not valid, with the reason in the log.
pub(super) fn reference_object(path: &Path) -> Option<Retained<ARReferenceObject>> {
    let url = NSURL::fileURLWithPath(&NSString::from_str(path.to_str()?));
    // SAFETY: an initialiser that takes the address of a file, and checks what it reads.
    let read = unsafe { ARReferenceObject::initWithArchiveURL_error(ARReferenceObject::alloc(), &url) };
    read.inspect_err(|error| eprintln!("arkit: {}: no scan: {error}", path.display()))
        .ok()
}
