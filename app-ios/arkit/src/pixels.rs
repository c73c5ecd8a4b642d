//! The bytes of a pixel buffer.

use app_core::camera_frame::PlanarImage;
use objc2_core_video::{
    CVPixelBuffer, CVPixelBufferGetBaseAddressOfPlane, CVPixelBufferGetBytesPerRowOfPlane,
    CVPixelBufferGetHeight, CVPixelBufferGetHeightOfPlane, CVPixelBufferGetPixelFormatType,
    CVPixelBufferGetPlaneCount, CVPixelBufferGetWidth, CVPixelBufferLockBaseAddress, CVPixelBufferLockFlags,
    CVPixelBufferUnlockBaseAddress,
};

use super::frame::{RawPlane, image};

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

    fn plane(&self, index: usize) -> RawPlane<'_> {
        let row_stride = CVPixelBufferGetBytesPerRowOfPlane(self.0, index);
        let n_bytes = row_stride * CVPixelBufferGetHeightOfPlane(self.0, index);
        let first = CVPixelBufferGetBaseAddressOfPlane(self.0, index).cast::<u8>();
        let bytes = if first.is_null() {
            &[]
        } else {
            // SAFETY: the buffer is locked for as long as `self` lives, and has this number of rows
            // of this length.
            unsafe { std::slice::from_raw_parts(first, n_bytes) }
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
