//! ARKit's segmentation of people: asks for it, and reads its mask.

use app_core::people::People;
use objc2::{ClassType, msg_send};
use objc2_ar_kit::{ARConfiguration, ARFrame, ARFrameSemantics, ARWorldTrackingConfiguration};
use objc2_core_video::{
    CVPixelBufferGetBaseAddress, CVPixelBufferGetBytesPerRow, CVPixelBufferGetHeight,
    CVPixelBufferGetPixelFormatType, CVPixelBufferGetWidth,
};

use super::people::{RawMask, people};
use super::pixels::Locked;

/// Asks for masks of people beside what a configuration asks for already, if this phone can do both.
pub(super) fn ask(configuration: &ARConfiguration) {
    // SAFETY: a property of a configuration of our own.
    let semantics = unsafe { configuration.frameSemantics() } | ARFrameSemantics::PersonSegmentation;
    let class = ARWorldTrackingConfiguration::class();
    // The class that is asked matters, and the binding has the method on its parent alone.
    // SAFETY: a method of every configuration's class that takes semantics and returns a truth value.
    let can: bool = unsafe { msg_send![class, supportsFrameSemantics: semantics] };
    if can {
        // SAFETY: the class supports these semantics.
        unsafe { configuration.setFrameSemantics(semantics) };
    }
}

/// The mask of a frame; `None` if it has none, or it cannot be read.
pub(super) fn read(frame: &ARFrame) -> Option<People> {
    // SAFETY: a property of a frame that was delivered, which never changes.
    let buffer = unsafe { frame.segmentationBuffer() }?;
    let _locked = Locked::new(&buffer)?;
    let size_px = [CVPixelBufferGetWidth(&buffer), CVPixelBufferGetHeight(&buffer)];
    let row_stride = CVPixelBufferGetBytesPerRow(&buffer);
    let first = CVPixelBufferGetBaseAddress(&buffer).cast::<u8>();
    if first.is_null() {
        return None;
    }
    // SAFETY: the buffer is not planar, and it is locked until this returns; it has this number of
    // rows of this length.
    let bytes = unsafe { std::slice::from_raw_parts(first, row_stride * size_px[1]) };
    people(&RawMask {
        pixel_format: CVPixelBufferGetPixelFormatType(&buffer),
        size_px,
        bytes,
        row_stride,
    })
}
