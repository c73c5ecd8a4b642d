//! Pictures as buffers for Apple's frameworks.

use std::ptr::{self, NonNull};

use objc2_core_foundation::CFRetained;
use objc2_core_video::{
    CVPixelBuffer, CVPixelBufferCreate, CVPixelBufferGetBaseAddress, CVPixelBufferGetBaseAddressOfPlane,
    CVPixelBufferGetBytesPerRow, CVPixelBufferGetBytesPerRowOfPlane, CVPixelBufferLockBaseAddress,
    CVPixelBufferLockFlags, CVPixelBufferUnlockBaseAddress,
};

/// `kCVPixelFormatType_32BGRA`.
const BGRA: u32 = u32::from_be_bytes(*b"BGRA");
/// `kCVPixelFormatType_420YpCbCr8BiPlanarFullRange`.
const FULL_RANGE: u32 = u32::from_be_bytes(*b"420f");

/// A buffer of this number of columns and rows; `fill` writes each row, given its index, with four
/// bytes per pixel in the order blue, green, red, alpha. `None` if there is no memory for it.
pub fn bgra(size: [usize; 2], fill: impl Fn(usize, &mut [u8])) -> Option<CFRetained<CVPixelBuffer>> {
    let [columns, rows] = size;
    made(size, BGRA, |buffer| {
        let first = CVPixelBufferGetBaseAddress(buffer).cast();
        let row_bytes = CVPixelBufferGetBytesPerRow(buffer);
        // SAFETY: the buffer is locked for writing, and has this number of rows of this length.
        unsafe { write_rows((first, row_bytes), [4 * columns, rows], fill) }
    })
}

/// A buffer of luma and interleaved Cb and Cr in full range, from packed data, with even numbers of
/// columns and rows. `None` if there is no memory for it, or if the data are too short.
pub fn planes(size: [usize; 2], [luma, chroma]: [&[u8]; 2]) -> Option<CFRetained<CVPixelBuffer>> {
    let [columns, rows] = size;
    let heights = [rows, rows / 2];
    let planes = [luma, chroma];
    let is_whole = |n: usize| planes[n].len() >= columns * heights[n];
    if !is_whole(0) || !is_whole(1) {
        return None;
    }
    made(size, FULL_RANGE, |buffer| {
        (0..2).all(|plane| {
            let first = CVPixelBufferGetBaseAddressOfPlane(buffer, plane).cast();
            let row_bytes = CVPixelBufferGetBytesPerRowOfPlane(buffer, plane);
            let copy = |row: usize, to: &mut [u8]| {
                to.copy_from_slice(&planes[plane][row * columns..][..columns]);
            };
            // SAFETY: the buffer is locked for writing, and the plane has this number of rows of
            // this length.
            unsafe { write_rows((first, row_bytes), [columns, heights[plane]], copy) }
        })
    })
}

/// A buffer that `write` has filled while it was locked; `None` if there is no memory, or if
/// `write` fails.
fn made(
    [columns, rows]: [usize; 2],
    format: u32,
    write: impl FnOnce(&CVPixelBuffer) -> bool,
) -> Option<CFRetained<CVPixelBuffer>> {
    let mut made: *mut CVPixelBuffer = ptr::null_mut();
    // SAFETY: a buffer without attributes of its own; the created object is owned.
    let buffer = unsafe {
        let status = CVPixelBufferCreate(None, columns, rows, format, None, NonNull::from(&mut made));
        CFRetained::from_raw(NonNull::new(made).filter(|_| status == 0)?)
    };
    let to_write = CVPixelBufferLockFlags(0);
    // SAFETY: the buffer has no other user, and is unlocked with the same flags below.
    if unsafe { CVPixelBufferLockBaseAddress(&buffer, to_write) } != 0 {
        return None;
    }
    let is_written = write(&buffer);
    // SAFETY: it was locked with these flags.
    unsafe { CVPixelBufferUnlockBaseAddress(&buffer, to_write) };
    is_written.then_some(buffer)
}

/// Writes each row's bytes; returns false if there are none, or if rows are shorter than that.
///
/// # Safety
/// From the first byte on there is this number of rows, of `row_bytes` each, which nothing else
/// uses.
unsafe fn write_rows(
    (first, row_bytes): (*mut u8, usize),
    [n_bytes, rows]: [usize; 2],
    write: impl Fn(usize, &mut [u8]),
) -> bool {
    if first.is_null() || row_bytes < n_bytes {
        return false;
    }
    // SAFETY: guaranteed by the caller.
    let bytes = unsafe { std::slice::from_raw_parts_mut(first, row_bytes * rows) };
    for (row, bytes) in bytes.chunks_mut(row_bytes).enumerate() {
        write(row, &mut bytes[..n_bytes]);
    }
    true
}
