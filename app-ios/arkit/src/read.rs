//! Reads an `ARFrame` into plain numbers. This is the shell's only file that reads a frame of
//! ARKit.

use std::ffi::c_void;

use app_core::camera_frame::PlanarImage;
use objc2::rc::Retained;
use objc2::runtime::Sel;
use objc2::{Message, msg_send, sel};
use objc2_ar_kit::{
    ARAnchor, ARFrame, ARImageAnchor, ARObjectAnchor, ARPlaneAnchor, ARPlaneGeometry, ARTrackable,
};
use objc2_core_video::{
    CVPixelBuffer, CVPixelBufferGetHeight, CVPixelBufferGetPixelFormatType, CVPixelBufferGetWidth,
};
use objc2_foundation::{NSArray, NSNumber, NSProcessInfo, ns_string};

use super::depth::RawDepth;
use super::frame::{RawFrame, RawSurface};
use super::pixels::Locked;
use super::shim;
use super::textures::TextureCache;

/// Number of a boundary's corners above which it is refused: ARKit's have a few dozen.
const MAX_CORNERS: usize = 4096;

/// Gives `take` the content of `frame`, with its picture if `textures` lend it; otherwise the
/// pixels can be read until it returns. `None` if the pixels cannot be read.
///
/// `held` is the requested anchor: its number, and the bytes of its identifier. `orientation` is
/// that of the screen.
pub(super) fn with_raw<T>(
    frame: &ARFrame,
    held: Option<(u64, [u8; 16])>,
    orientation: isize,
    textures: Option<&TextureCache>,
    take: impl FnOnce(&RawFrame<'_>, Option<PlanarImage>) -> T,
) -> Option<T> {
    // SAFETY: properties of a frame that was delivered, which never change.
    let (camera, buffer, timestamp, light, anchors) = unsafe {
        (
            frame.camera(),
            frame.capturedImage(),
            frame.timestamp(),
            frame.lightEstimate(),
            frame.anchors(),
        )
    };
    let maps = depth_maps(frame);
    let locked_maps = maps.as_ref().and_then(LockedMaps::new);
    // SAFETY: a property of a frame that was delivered, which never changes.
    let people = unsafe { frame.segmentationBuffer() };
    let locked_people = people.as_deref().and_then(Locked::new);
    let lent = textures.and_then(|textures| textures.lend(&buffer));
    let locked = if lent.is_none() {
        Some(Locked::new(&buffer)?)
    } else {
        None
    };
    let anchor = held.and_then(|(id, identifier)| Some((id, anchor_of(&anchors, identifier)?)));
    let surfaces = anchors
        .iter()
        .filter_map(|anchor| anchor.downcast::<ARPlaneAnchor>().ok());
    // SAFETY: properties of the frame's camera; both matrices are SIMD matrices of the shapes asked for.
    let (intrinsics, transform, tracking, exposure) = unsafe {
        (
            shim::columns3(pointer(&*camera), selector(sel!(intrinsics))).0,
            shim::columns4(pointer(&*camera), selector(sel!(transform))).0,
            [camera.trackingState().0, camera.trackingStateReason().0],
            iso(frame).map(|iso| [camera.exposureDuration(), iso]),
        )
    };
    let raw = RawFrame {
        timestamp,
        // This is the same clock.
        delivered: NSProcessInfo::processInfo().systemUptime(),
        pixel_format: CVPixelBufferGetPixelFormatType(&buffer),
        size_px: [CVPixelBufferGetWidth(&buffer), CVPixelBufferGetHeight(&buffer)],
        planes: locked.as_ref().map(Locked::planes).unwrap_or_default(),
        intrinsics,
        transform,
        tracking,
        exposure,
        depth: locked_maps.as_ref().and_then(LockedMaps::raw),
        people: locked_people.as_ref().and_then(Locked::map),
        // SAFETY: properties of an estimate that never changes.
        light: light.map(|light| unsafe { [light.ambientIntensity(), light.ambientColorTemperature()] }),
        surfaces: surfaces.map(|anchor| surface(&anchor)).collect(),
        card: anchors.iter().find_map(|anchor| card(&anchor)),
        anchor,
        toy: anchors.iter().find_map(|anchor| toy(&anchor)),
        orientation,
    };
    Some(take(&raw, lent))
}

/// The pixel buffers of a frame's depths and of their confidence; `None` if they are not measured.
fn depth_maps(frame: &ARFrame) -> Option<(Retained<CVPixelBuffer>, Option<Retained<CVPixelBuffer>>)> {
    // SAFETY: properties of a frame that was delivered and of its depths, which never change.
    unsafe {
        let data = frame.sceneDepth()?;
        Some((data.depthMap(), data.confidenceMap()))
    }
}

/// Depths and their confidence, while they may be read.
struct LockedMaps<'a> {
    metres: Locked<'a>,
    confidence: Option<Locked<'a>>,
}

impl<'a> LockedMaps<'a> {
    /// Returns `None` if a buffer cannot be locked.
    fn new(
        (metres, confidence): &'a (Retained<CVPixelBuffer>, Option<Retained<CVPixelBuffer>>),
    ) -> Option<Self> {
        Some(Self {
            metres: Locked::new(metres)?,
            confidence: match confidence {
                Some(confidence) => Some(Locked::new(confidence)?),
                None => None,
            },
        })
    }

    /// Returns `None` if a buffer is planar.
    fn raw(&self) -> Option<RawDepth<'_>> {
        Some(RawDepth {
            metres: self.metres.map()?,
            confidence: match &self.confidence {
                Some(confidence) => Some(confidence.map()?),
                None => None,
            },
        })
    }
}

/// The ISO speed of the picture; `None` if its Exif data do not contain it.
fn iso(frame: &ARFrame) -> Option<f64> {
    // SAFETY: a property of a frame that was delivered, which never changes.
    let exif = unsafe { frame.exifData() };
    // Exif has a list of speeds; a camera sets the first.
    let speeds = exif.objectForKey(ns_string!("ISOSpeedRatings"))?;
    let speed = speeds.downcast::<NSArray>().ok()?.firstObject()?;
    Some(speed.downcast::<NSNumber>().ok()?.doubleValue())
}

/// Pose of the anchor with this identifier.
fn anchor_of(anchors: &NSArray<ARAnchor>, identifier: [u8; 16]) -> Option<[[f32; 4]; 4]> {
    // SAFETY: properties of an anchor, which never change; the transform is a SIMD matrix of four columns.
    anchors.iter().find_map(|anchor| unsafe {
        let is_it = anchor.identifier().as_bytes() == identifier;
        is_it.then(|| shim::columns4(pointer(&*anchor), selector(sel!(transform))).0)
    })
}

/// Pose of the card, if this is its anchor and the card is in view: it is the only image that is
/// detected.
fn card(anchor: &ARAnchor) -> Option<[[f32; 4]; 4]> {
    let image = anchor.downcast_ref::<ARImageAnchor>()?;
    // SAFETY: properties of an anchor, which never change; the transform is a SIMD matrix of four columns.
    unsafe {
        image
            .isTracked()
            .then(|| shim::columns4(pointer(image), selector(sel!(transform))).0)
    }
}

/// Pose of the recognised toy, if this is its anchor: it is the only object that is detected.
fn toy(anchor: &ARAnchor) -> Option<[[f32; 4]; 4]> {
    let object = anchor.downcast_ref::<ARObjectAnchor>()?;
    // SAFETY: a property of an anchor, which never changes; it is a SIMD matrix of four columns.
    Some(unsafe { shim::columns4(pointer(object), selector(sel!(transform))).0 })
}

fn surface(anchor: &ARPlaneAnchor) -> RawSurface {
    // SAFETY: properties of an anchor, which never change; the transform is a SIMD matrix of four columns.
    let (identifier, alignment, transform, geometry) = unsafe {
        (
            anchor.identifier(),
            anchor.alignment().0,
            shim::columns4(pointer(anchor), selector(sel!(transform))).0,
            anchor.geometry(),
        )
    };
    RawSurface {
        id: identifier.as_bytes(),
        alignment,
        transform,
        boundary: boundary(&geometry),
    }
}

fn boundary(geometry: &Retained<ARPlaneGeometry>) -> Vec<[f32; 4]> {
    // SAFETY: properties of a geometry that never changes. The corners are `simd_float3`s, which take 16 bytes each and
    // belong to the geometry, which outlives the copy.
    unsafe {
        let n_corners = geometry.boundaryVertexCount();
        let corners: *const c_void = msg_send![&**geometry, boundaryVertices];
        if corners.is_null() || n_corners > MAX_CORNERS {
            return Vec::new();
        }
        std::slice::from_raw_parts(corners.cast::<[f32; 4]>(), n_corners).to_vec()
    }
}

fn pointer<T: Message>(object: &T) -> *const c_void {
    std::ptr::from_ref(object).cast()
}

pub(super) fn selector(selector: Sel) -> *const c_void {
    // SAFETY: a selector is one pointer, by objc2's own layout.
    unsafe { std::mem::transmute::<Sel, *const c_void>(selector) }
}
