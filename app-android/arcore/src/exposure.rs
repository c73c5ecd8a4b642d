//! Exposure of the camera's picture, from the metadata of Android's camera.

use app_core::camera_frame::Exposure;

use super::ffi::{ArImageMetadata, ArImageMetadata_const_entry};
use super::owned::Owned;
use super::session::Session;
use super::status::Failure;

/// `ACAMERA_SENSOR_EXPOSURE_TIME` of Android's `NdkCameraMetadataTags.h`: nanoseconds, 64 bits.
const EXPOSURE_TIME: u32 = 14 << 16;
/// `ACAMERA_SENSOR_SENSITIVITY`: ISO speed, 32 bits.
const SENSITIVITY: u32 = (14 << 16) + 2;
/// `ACAMERA_CONTROL_AF_MODE`: a byte, 0 if the lens stays in place.
const FOCUS_MODE: u32 = (1 << 16) + 7;
/// `ACAMERA_TYPE_BYTE`.
const BYTE: u8 = 0;
/// `ACAMERA_TYPE_INT32`.
const INT32: u8 = 1;
/// `ACAMERA_TYPE_INT64`.
const INT64: u8 = 3;

impl Session {
    /// Exposure of the last update's frame; `None` if the camera does not report it.
    pub(super) fn exposure(&self) -> Option<Exposure> {
        let metadata = self.metadata()?;
        let (time, speed) = (
            self.entry(&metadata, EXPOSURE_TIME, INT64)?,
            self.entry(&metadata, SENSITIVITY, INT32)?,
        );
        // SAFETY: both entries have at least one number of the requested type, until the metadata
        // are released.
        let (time_ns, iso) = unsafe {
            (
                time.cast::<i64>().read_unaligned(),
                speed.cast::<i32>().read_unaligned(),
            )
        };
        let duration_s = 1e-9 * time_ns as f64;
        let iso = f64::from(iso);
        let exposure = Exposure { duration_s, iso };
        exposure.amount().map(|_| exposure)
    }

    /// Whether the camera focuses automatically; `None` if it does not report that.
    pub(super) fn focuses_by_itself(&self) -> Option<bool> {
        let metadata = self.metadata()?;
        let mode = self.entry(&metadata, FOCUS_MODE, BYTE)?;
        // SAFETY: the entry has at least one byte, until the metadata are released.
        Some(unsafe { mode.read() } != 0)
    }

    /// The camera's metadata for the last update's frame.
    fn metadata(&self) -> Option<Owned<ArImageMetadata>> {
        let (api, raw) = (&self.api, self.raw());
        let mut status = 0;
        // SAFETY: session and frame live; acquired metadata are ours to release.
        let metadata = unsafe {
            Owned::new(
                |place| status = (api.ArFrame_acquireImageMetadata)(raw, self.frame.as_ptr(), place),
                api.ArImageMetadata_release,
            )
        };
        Failure::check(status).ok()?;
        metadata
    }

    /// Pointer to the numbers of an entry, if there are any of that type.
    fn entry(&self, metadata: &Owned<ArImageMetadata>, tag: u32, kind: u8) -> Option<*const u8> {
        let mut entry = ArImageMetadata_const_entry {
            tag: 0,
            kind: 0,
            count: 0,
            data: std::ptr::null(),
        };
        // SAFETY: session and metadata live, and the entry is a variable of ours.
        let status = unsafe {
            let get = self.api.ArImageMetadata_getConstEntry;
            get(self.raw(), metadata.as_ptr(), tag, &raw mut entry)
        };
        let is_reported = status == 0 && entry.kind == kind && entry.count > 0 && !entry.data.is_null();
        is_reported.then_some(entry.data)
    }
}
