//! The bytes of a pixel buffer.

use app_core::camera_frame::PlanarImage;
use objc2_core_video::{
    CVPixelBuffer, CVPixelBufferGetBaseAddress, CVPixelBufferGetBaseAddressOfPlane,
    CVPixelBufferGetBytesPerRow, CVPixelBufferGetBytesPerRowOfPlane, CVPixelBufferGetHeight,
    CVPixelBufferGetHeightOfPlane, CVPixelBufferGetPixelFormatType, CVPixelBufferGetPlaneCount,
    CVPixelBufferGetWidth, CVPixelBufferLockBaseAddress, CVPixelBufferLockFlags,
    CVPixelBufferUnlockBaseAddress,
};

use super::frame::image;
use super::map::{RawMap, RawPlane};

/// A pixel buffer whose bytes may be read, until it is dropped.
pub(super) struct Locked<'a>(&'a CVPixelBuffer);

impl<'a> Locked<'a> {
    /// Returns `None` if the buffer cannot be locked.
    pub(super) fn new(buffer: &'a CVPixelBuffer) -> Option<Self> {
        // SAFETY: the buffer lives, and is unlocked with the same flag when this is dropped.
        let status = unsafe { CVPixelBufferLockBaseAddress(buffer, CVPixelBufferLockFlags::ReadOnly) };
        (status == 0).then_some(Self(buffer))
    }

    pub(super) fn planes(&self) -> Vec<RawPlane<'_>> {
        let n_planes = CVPixelBufferGetPlaneCount(self.0);
        (0..n_planes).map(|index| self.plane(index)).collect()
    }

    /// The pixels of the buffer; `None` if it is planar.
    pub(super) fn map(&self) -> Option<RawMap<'_>> {
        if CVPixelBufferGetPlaneCount(self.0) != 0 {
            return None;
        }
        let size_px = [CVPixelBufferGetWidth(self.0), CVPixelBufferGetHeight(self.0)];
        let row_stride = CVPixelBufferGetBytesPerRow(self.0);
        let first = CVPixelBufferGetBaseAddress(self.0).cast::<u8>();
        Some(RawMap {
            pixel_format: CVPixelBufferGetPixelFormatType(self.0),
            size_px,
            plane: self.rows(first, row_stride, size_px[1]),
        })
    }

    fn plane(&self, index: usize) -> RawPlane<'_> {
        let row_stride = CVPixelBufferGetBytesPerRowOfPlane(self.0, index);
        let n_rows = CVPixelBufferGetHeightOfPlane(self.0, index);
        let first = CVPixelBufferGetBaseAddressOfPlane(self.0, index).cast::<u8>();
        self.rows(first, row_stride, n_rows)
    }

    /// Rows of this length that begin at an address of the buffer, or none at a null pointer.
    fn rows(&self, first: *const u8, row_stride: usize, n_rows: usize) -> RawPlane<'_> {
        let bytes = if first.is_null() {
            &[]
        } else {
            // SAFETY: the buffer is locked for as long as `self` lives, and has this number of rows
            // of this length.
            unsafe { std::slice::from_raw_parts(first, row_stride * n_rows) }
        };
        RawPlane { bytes, row_stride }
    }
}

impl Drop for Locked<'_> {
    fn drop(&mut self) {
        // SAFETY: it was locked with this flag.
        unsafe { CVPixelBufferUnlockBaseAddress(self.0, CVPixelBufferLockFlags::ReadOnly) };
    }
}

/// A copy of a buffer's picture; `None` if it cannot be read.
pub(super) fn copied(buffer: &CVPixelBuffer) -> Option<PlanarImage> {
    let locked = Locked::new(buffer)?;
    let size_px = [CVPixelBufferGetWidth(buffer), CVPixelBufferGetHeight(buffer)];
    image(CVPixelBufferGetPixelFormatType(buffer), size_px, &locked.planes()).ok()
}
