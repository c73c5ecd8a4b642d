//! The printed card as an image for ARKit.

use app_core::card::{PATTERN_M, reference};
use objc2::AnyThread;
use objc2::rc::Retained;
use objc2_ar_kit::ARReferenceImage;
use objc2_foundation::ns_string;
use objc2_image_io::CGImagePropertyOrientation;

use ios_media::pixels;

/// The card's reference image; `None` if there is no memory for it.
pub(super) fn reference_image() -> Option<Retained<ARReferenceImage>> {
    let pattern = reference();
    let [columns, rows] = pattern.size_px.map(|side| side as usize);
    let buffer = pixels::bgra([columns, rows], |row, bgra| {
        let codes = &pattern.codes[row * columns..][..columns];
        for (pixel, code) in bgra.chunks_exact_mut(4).zip(codes) {
            pixel.copy_from_slice(&[*code, *code, *code, 255]);
        }
    })?;
    // SAFETY: the buffer holds an upright picture, which has this width in metres when it is
    // printed.
    unsafe {
        let empty = ARReferenceImage::alloc();
        let up = CGImagePropertyOrientation::Up;
        let image =
            ARReferenceImage::initWithPixelBuffer_orientation_physicalWidth(empty, &buffer, up, PATTERN_M);
        image.setName(Some(ns_string!("card")));
        Some(image)
    }
}
