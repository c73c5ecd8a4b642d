//! The content of one ARCore frame, copied into plain values of ours.

use app_core::camera_frame::{
    CameraFrame, CameraImage, CodeRange, Display, LumaCoefficients, PlanarImage, Plane, PlaneError, Planes,
    Stamp, Tracking, YcbcrEncoding,
};
use app_core::scene::Intrinsics;
use glam::DMat4;
use rustix::time::{ClockId, clock_gettime};

use super::ffi::{ArAugmentedImage, ArCamera, ArImage, ArPose, ArTrackable, STOPPED, TRACKING};
use super::owned::Owned;
use super::session::Session;
use super::status::{
    DEADLINE_EXCEEDED, Failure, NOT_YET_AVAILABLE, RESOURCE_EXHAUSTED, tracking_without_pose,
};
use crate::convert;

/// `AR_IMAGE_FORMAT_YUV_420_888`.
const YUV_420: i32 = 0x23;
/// `AR_TRACKABLE_AUGMENTED_IMAGE`.
const IMAGES: i32 = 0x4152_0104;
/// `AR_AUGMENTED_IMAGE_TRACKING_METHOD_FULL_TRACKING`: the image is visible in this frame.
const IS_SEEN: i32 = 1;
/// Android's default encoding of pictures for the processor; ARCore does not report it.
const ENCODING: YcbcrEncoding = YcbcrEncoding {
    coefficients: LumaCoefficients::Bt601,
    range: CodeRange::Full,
};
/// Why a frame could not be read.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// ARCore reports the reason.
    #[error(transparent)]
    Failed(#[from] Failure),
    /// The picture does not consist of luma and chroma.
    #[error("the camera's picture has format {0:#x}, not YUV_420_888")]
    Format(i32),
    /// The number of planes is wrong.
    #[error("the camera's picture has {0} planes, not 3")]
    Count(i32),
    /// The planes do not contain their picture.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// The camera's numbers are impossible.
    #[error("the camera's focal length is {0:?} px, its picture {1:?} px")]
    Camera([f32; 2], [i32; 2]),
    /// No picture arrived in any mode of the camera.
    #[error("the camera delivers no picture in any size")]
    NoPictures,
}

/// Nanoseconds in a second.
const NS: i64 = 1_000_000_000;
/// The possible clocks of ARCore's times, which it does not specify: they differ by the time that
/// the phone slept.
#[cfg(any(target_os = "android", target_os = "linux"))]
const CLOCKS: &[ClockId] = &[ClockId::Boottime, ClockId::Monotonic];
#[cfg(not(any(target_os = "android", target_os = "linux")))]
const CLOCKS: &[ClockId] = &[ClockId::Monotonic];

/// Age of a picture, by the only clock that fits.
fn age_ms(stamp: Stamp) -> Option<f64> {
    let times = CLOCKS.iter().map(|clock| clock_gettime(*clock));
    times
        .filter_map(|now| now.tv_sec.checked_mul(NS)?.checked_add(now.tv_nsec))
        .find_map(|now_ns| stamp.age_ms(now_ns))
}

impl Session {
    /// Time of the last update's frame; 0 before the first.
    pub(super) fn time_ns(&self) -> i64 {
        let mut time_ns = 0;
        // SAFETY: session and frame live, and the time is a variable of ours.
        unsafe { (self.api.ArFrame_getTimestamp)(self.raw(), self.frame.as_ptr(), &raw mut time_ns) };
        time_ns
    }

    /// The frame of the last update; `None` if its picture is missing, as at the start and under
    /// load.
    pub(super) fn read(&self, stamp: Stamp) -> Result<Option<CameraFrame>, FrameError> {
        let Some(image) = self.image()? else {
            return Ok(None);
        };
        let api = &self.api;
        // SAFETY: session and frame live; an acquired camera is ours to release.
        let camera: Option<Owned<ArCamera>> = unsafe {
            Owned::new(
                |place| (api.ArFrame_acquireCamera)(self.raw(), self.frame.as_ptr(), place),
                api.ArCamera_release,
            )
        };
        let camera = camera.ok_or(Failure(-2))?;
        let (mut state, mut reason) = (STOPPED, 0);
        // SAFETY: session, camera and pose live, and the numbers are variables of ours.
        unsafe {
            (api.ArCamera_getTrackingState)(self.raw(), camera.as_ptr(), &raw mut state);
            (api.ArCamera_getTrackingFailureReason)(self.raw(), camera.as_ptr(), &raw mut reason);
            (api.ArCamera_getPose)(self.raw(), camera.as_ptr(), self.pose.as_ptr());
        }
        let pose = (state == TRACKING).then(|| convert::world_from_camera(self.pose_raw(&self.pose)));
        let world_from_camera = pose.flatten();
        let is_tracking = world_from_camera.is_some();
        if is_tracking {
            self.follow_turns(&camera);
        }
        Ok(Some(CameraFrame {
            stamp,
            age_ms: age_ms(stamp),
            intrinsics: self.intrinsics(&camera, image.size_px())?,
            image,
            exposure: self.exposure(),
            tracking: if is_tracking {
                Tracking::Normal
            } else {
                tracking_without_pose(reason)
            },
            world_from_camera,
            planes: if is_tracking { self.planes() } else { Vec::new() }.into(),
            anchors: self.held().filter(|_| is_tracking).into_iter().collect(),
            world_from_card: if is_tracking { self.card() } else { None },
            // ARCore's estimate would cost time with each picture, and improved none of the
            // measured sessions.
            light_estimate: None,
            // ARCore masks no people: its scene semantics are made for streets.
            people: None,
            depth: None,
            display: Display {
                quarter_turns: self.quarter_turns(),
                ..Display::default()
            },
        }))
    }

    /// Determines the rotation of the sensor in the phone, from the camera's pose in the display's
    /// axes and in the sensor's.
    fn follow_turns(&self, camera: &Owned<ArCamera>) {
        let of_sensor = self.pose_raw(&self.pose);
        // SAFETY: session, camera and pose live.
        unsafe {
            let get = self.api.ArCamera_getDisplayOrientedPose;
            get(self.raw(), camera.as_ptr(), self.pose.as_ptr());
        }
        if let Some(turns) = convert::quarter_turns(of_sensor, self.pose_raw(&self.pose)) {
            self.learn_turns(turns);
        }
    }

    pub(super) fn pose_raw(&self, pose: &Owned<ArPose>) -> [f32; 7] {
        let mut numbers = [0.0; 7];
        // SAFETY: session and pose live, and the function writes seven numbers.
        unsafe { (self.api.ArPose_getPoseRaw)(self.raw(), pose.as_ptr(), numbers.as_mut_ptr()) };
        numbers
    }

    fn intrinsics(&self, camera: &Owned<ArCamera>, size_px: [u32; 2]) -> Result<Intrinsics, FrameError> {
        let ([mut fx, mut fy], [mut cx, mut cy], [mut width, mut height]) = ([0.0; 2], [0.0; 2], [0; 2]);
        let (api, raw, intrinsics) = (&self.api, self.raw(), self.intrinsics.as_ptr());
        // SAFETY: session, camera and intrinsics live, and the numbers are variables of ours.
        unsafe {
            (api.ArCamera_getImageIntrinsics)(raw, camera.as_ptr(), intrinsics);
            (api.ArCameraIntrinsics_getFocalLength)(raw, intrinsics, &raw mut fx, &raw mut fy);
            (api.ArCameraIntrinsics_getPrincipalPoint)(raw, intrinsics, &raw mut cx, &raw mut cy);
            (api.ArCameraIntrinsics_getImageDimensions)(raw, intrinsics, &raw mut width, &raw mut height);
        }
        let is_of_picture = size_px.map(i64::from) == [width, height].map(i64::from);
        convert::intrinsics([fx, fy], [cx, cy])
            .filter(|_| is_of_picture)
            .ok_or(FrameError::Camera([fx, fy], [width, height]))
    }

    fn image(&self) -> Result<Option<CameraImage>, FrameError> {
        let api = &self.api;
        let mut status = 0;
        // SAFETY: session and frame live; an acquired image is ours to release.
        let image: Option<Owned<ArImage>> = unsafe {
            Owned::new(
                |place| {
                    status = (api.ArFrame_acquireCameraImage)(self.raw(), self.frame.as_ptr(), place);
                },
                api.ArImage_release,
            )
        };
        match Failure::check(status) {
            Err(Failure(NOT_YET_AVAILABLE | RESOURCE_EXHAUSTED | DEADLINE_EXCEEDED)) => return Ok(None),
            result => result?,
        }
        let image = image.ok_or(Failure(-2))?;
        let ([mut width, mut height], mut format, mut n_planes) = ([0; 2], 0, 0);
        // SAFETY: session and image live, and the numbers are variables of ours.
        unsafe {
            (api.ArImage_getWidth)(self.raw(), image.as_ptr(), &raw mut width);
            (api.ArImage_getHeight)(self.raw(), image.as_ptr(), &raw mut height);
            (api.ArImage_getFormat)(self.raw(), image.as_ptr(), &raw mut format);
            (api.ArImage_getNumberOfPlanes)(self.raw(), image.as_ptr(), &raw mut n_planes);
        }
        if format != YUV_420 {
            return Err(FrameError::Format(format));
        }
        if n_planes != 3 {
            return Err(FrameError::Count(n_planes));
        }
        let [luma, blue, red] = [0, 1, 2].map(|index| self.plane(&image, index));
        let planes = Planes {
            // A negative side is refused like an excessive one.
            size_px: [width, height].map(|side| u32::try_from(side).unwrap_or(0)),
            luma,
            blue,
            red,
            encoding: ENCODING,
        };
        Ok(Some(PlanarImage::new(&planes)?.into()))
    }

    /// One component, for as long as the image is held. Invalid data become an empty plane.
    fn plane<'a>(&self, image: &'a Owned<ArImage>, index: i32) -> Plane<'a> {
        let (mut data, mut n_bytes, mut row_stride, mut pixel_stride) = (std::ptr::null(), 0, 0, 0);
        let (api, raw, image) = (&self.api, self.raw(), image.as_ptr());
        // SAFETY: session and image live, the image has three planes, and all outputs are variables
        // of ours.
        unsafe {
            (api.ArImage_getPlaneData)(raw, image, index, &raw mut data, &raw mut n_bytes);
            (api.ArImage_getPlaneRowStride)(raw, image, index, &raw mut row_stride);
            (api.ArImage_getPlanePixelStride)(raw, image, index, &raw mut pixel_stride);
        }
        let [n_bytes, row_stride, pixel_stride] =
            [n_bytes, row_stride, pixel_stride].map(|number| usize::try_from(number).unwrap_or(0));
        let bytes = if data.is_null() {
            &[]
        } else {
            // SAFETY: ARCore guarantees this number of bytes until the image is released.
            unsafe { std::slice::from_raw_parts(data, n_bytes) }
        };
        Plane {
            bytes,
            row_stride,
            pixel_stride,
        }
    }

    /// Pose of the card, while it is visible.
    fn card(&self) -> Option<DMat4> {
        let mut found = self.trackables_of(IMAGES);
        found.find_map(|trackable| self.pose_of_card(&trackable))
    }

    fn pose_of_card(&self, trackable: &Owned<ArTrackable>) -> Option<DMat4> {
        let (api, raw) = (&self.api, self.raw());
        // The list contains only images, which are trackables in C by a cast.
        let image: *const ArAugmentedImage = trackable.as_ptr().cast_const().cast();
        let (mut state, mut method) = (STOPPED, 0);
        // SAFETY: session, image and pose live, and the numbers are variables of ours.
        unsafe {
            (api.ArTrackable_getTrackingState)(raw, trackable.as_ptr(), &raw mut state);
            (api.ArAugmentedImage_getTrackingMethod)(raw, image, &raw mut method);
            (api.ArAugmentedImage_getCenterPose)(raw, image, self.pose.as_ptr());
        }
        // A pose has the same numbers for every kind of object.
        let world_from_card = convert::world_from_camera(self.pose_raw(&self.pose));
        world_from_card.filter(|_| state == TRACKING && method == IS_SEEN)
    }
}
