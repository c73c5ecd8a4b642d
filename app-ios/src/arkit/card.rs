//! The printed card, as ARKit knows it.

use std::ptr::{self, NonNull};

use app_core::card::{PATTERN_M, reference};
use objc2::AnyThread;
use objc2::rc::Retained;
use objc2_ar_kit::ARReferenceImage;
use objc2_core_foundation::CFRetained;
use objc2_core_video::{
    CVPixelBuffer, CVPixelBufferCreate, CVPixelBufferGetBaseAddress, CVPixelBufferGetBytesPerRow,
    CVPixelBufferLockBaseAddress, CVPixelBufferLockFlags, CVPixelBufferUnlockBaseAddress,
};
use objc2_foundation::ns_string;
use objc2_image_io::CGImagePropertyOrientation;

/// `kCVPixelFormatType_32BGRA`.
const BGRA: u32 = u32::from_be_bytes(*b"BGRA");

/// What the card is known by; none where there is no room for it.
pub(super) fn reference_image() -> Option<Retained<ARReferenceImage>> {
    let pattern = reference();
    let buffer = pixel_buffer(pattern.size_px, &pattern.codes)?;
    // SAFETY: the buffer holds an upright picture, which is so many metres wide where it is printed.
    unsafe {
        let empty = ARReferenceImage::alloc();
        let up = CGImagePropertyOrientation::Up;
        let image =
            ARReferenceImage::initWithPixelBuffer_orientation_physicalWidth(empty, &buffer, up, PATTERN_M);
        image.setName(Some(ns_string!("card")));
        Some(image)
    }
}

/// A buffer of greys.
fn pixel_buffer([width, height]: [u32; 2], codes: &[u8]) -> Option<CFRetained<CVPixelBuffer>> {
    let (columns, rows) = (width as usize, height as usize);
    let mut made: *mut CVPixelBuffer = ptr::null_mut();
    // SAFETY: a buffer without attributes of its own; what is made is owned.
    let buffer = unsafe {
        let status = CVPixelBufferCreate(None, columns, rows, BGRA, None, NonNull::from(&mut made));
        CFRetained::from_raw(NonNull::new(made).filter(|_| status == 0)?)
    };
    let to_write = CVPixelBufferLockFlags(0);
    // SAFETY: nobody else has the buffer, which is unlocked with the same flags below.
    if unsafe { CVPixelBufferLockBaseAddress(&buffer, to_write) } != 0 {
        return None;
    }
    let (first, row_bytes) = (
        CVPixelBufferGetBaseAddress(&buffer).cast::<u8>(),
        CVPixelBufferGetBytesPerRow(&buffer),
    );
    if !first.is_null() {
        // SAFETY: the buffer is locked and has so many rows of so many bytes.
        let bytes = unsafe { std::slice::from_raw_parts_mut(first, row_bytes * rows) };
        for (to, from) in bytes.chunks_mut(row_bytes).zip(codes.chunks(columns)) {
            let pixels = from.iter().flat_map(|code| [*code, *code, *code, 255]);
            to.iter_mut().zip(pixels).for_each(|(to, code)| *to = code);
        }
    }
    // SAFETY: it was locked with these flags.
    unsafe { CVPixelBufferUnlockBaseAddress(&buffer, to_write) };
    (!first.is_null()).then_some(buffer)
}
