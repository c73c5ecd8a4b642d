//! Pictures as buffers that Apple's frameworks take.

use std::ptr::{self, NonNull};

use objc2_core_foundation::CFRetained;
use objc2_core_video::{
    CVPixelBuffer, CVPixelBufferCreate, CVPixelBufferGetBaseAddress, CVPixelBufferGetBytesPerRow,
    CVPixelBufferLockBaseAddress, CVPixelBufferLockFlags, CVPixelBufferUnlockBaseAddress,
};

/// `kCVPixelFormatType_32BGRA`.
pub(crate) const BGRA: u32 = u32::from_be_bytes(*b"BGRA");

/// A buffer of as many columns and rows, whose rows are written by `fill`: its number, and four bytes a pixel, in the order
/// blue, green, red, alpha. None where there is no room for it.
pub(crate) fn buffer(
    [columns, rows]: [usize; 2],
    fill: impl Fn(usize, &mut [u8]),
) -> Option<CFRetained<CVPixelBuffer>> {
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
    if !first.is_null() && row_bytes >= 4 * columns {
        // SAFETY: the buffer is locked and has so many rows of so many bytes.
        let bytes = unsafe { std::slice::from_raw_parts_mut(first, row_bytes * rows) };
        for (row, bytes) in bytes.chunks_mut(row_bytes).enumerate() {
            fill(row, &mut bytes[..4 * columns]);
        }
    }
    // SAFETY: it was locked with these flags.
    unsafe { CVPixelBufferUnlockBaseAddress(&buffer, to_write) };
    (!first.is_null()).then_some(buffer)
}
