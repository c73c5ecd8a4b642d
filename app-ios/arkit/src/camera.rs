//! The camera's permission, and its exposure, white balance and focus.

use app_core::app::Permission;
use block2::RcBlock;
use objc2::rc::Retained;
use objc2::runtime::Bool;
use objc2::{ClassType, msg_send};
use objc2_ar_kit::ARWorldTrackingConfiguration;
use objc2_av_foundation::{
    AVCaptureDevice, AVCaptureExposureMode, AVCaptureFocusMode, AVCaptureWhiteBalanceMode, AVMediaTypeVideo,
};

use objc2_core_media::CMTime;

use crate::convert;

/// Time scale of durations that are set, in parts of a second.
const TIMESCALE: i32 = 1_000_000_000;

/// Whether the camera may be used.
pub fn permission() -> Permission {
    // SAFETY: a constant of AVFoundation.
    let Some(video) = (unsafe { AVMediaTypeVideo }) else {
        return Permission::Unknown;
    };
    // SAFETY: video is one of the two kinds of media for which a permission exists.
    convert::permission(unsafe { AVCaptureDevice::authorizationStatusForMediaType(video) }.0)
}

/// Asks the person; [`permission`] then returns the answer.
pub fn ask_permission() {
    // SAFETY: a constant of AVFoundation.
    let Some(video) = (unsafe { AVMediaTypeVideo }) else {
        return;
    };
    // The answer is polled with each picture.
    let answered = RcBlock::new(|_is_granted: Bool| {});
    // SAFETY: as above; the block has the method's arguments, and is retained by it.
    unsafe { AVCaptureDevice::requestAccessForMediaType_completionHandler(video, &answered) };
}

/// An exposure that can be restored.
pub struct Exposure {
    duration: CMTime,
    iso: f32,
}

/// The camera of world tracking, if its exposure can be set.
fn device() -> Option<Retained<AVCaptureDevice>> {
    // The receiving class matters, and the binding has the method on its parent alone. SAFETY: a
    // method of every configuration's class since iOS 16 that returns a device or nil.
    let device: Option<Retained<AVCaptureDevice>> = unsafe {
        msg_send![
            ARWorldTrackingConfiguration::class(),
            configurableCaptureDeviceForPrimaryCamera
        ]
    };
    if device.is_none() {
        eprintln!("arkit: this camera's exposure cannot be set");
    }
    device
}

/// Changes the camera's settings while it is locked for this app.
fn set(device: &AVCaptureDevice, change: impl FnOnce()) {
    // SAFETY: it is unlocked below.
    if let Err(error) = unsafe { device.lockForConfiguration() } {
        eprintln!("arkit: the camera cannot be set: {error}");
        return;
    }
    change();
    // SAFETY: it was locked above.
    unsafe { device.unlockForConfiguration() };
}

/// Holds exposure, white balance and focus, or lets them adapt to the picture again.
pub fn hold_exposure(is_held: bool) {
    let Some(device) = device() else { return };
    let (exposure, white_balance, focus) = if is_held {
        (
            AVCaptureExposureMode::Locked,
            AVCaptureWhiteBalanceMode::Locked,
            AVCaptureFocusMode::Locked,
        )
    } else {
        (
            AVCaptureExposureMode::ContinuousAutoExposure,
            AVCaptureWhiteBalanceMode::ContinuousAutoWhiteBalance,
            AVCaptureFocusMode::ContinuousAutoFocus,
        )
    };
    // SAFETY: modes are set while the device is locked, and only those that it supports.
    set(&device, || unsafe {
        if device.isExposureModeSupported(exposure) {
            device.setExposureMode(exposure);
        }
        if device.isWhiteBalanceModeSupported(white_balance) {
            device.setWhiteBalanceMode(white_balance);
        }
        if device.isFocusModeSupported(focus) {
            device.setFocusMode(focus);
        }
    });
}

/// Darkens the picture, and returns the previous exposure; `None` if the camera cannot.
pub fn underexpose() -> Option<Exposure> {
    let device = device()?;
    // SAFETY: properties of a camera and of its format.
    let (held, least_duration, least_iso) = unsafe {
        let format = device.activeFormat();
        let held = Exposure {
            duration: device.exposureDuration(),
            iso: device.ISO(),
        };
        (held, format.minExposureDuration(), format.minISO())
    };
    let least = [seconds(least_duration), f64::from(least_iso)];
    let [duration_s, iso] = convert::darkened([seconds(held.duration), f64::from(held.iso)], least)?;
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a speed that the camera has, and a part of a second"
    )]
    let (value, iso) = ((duration_s * f64::from(TIMESCALE)).ceil() as i64, iso as f32);
    let duration = CMTime {
        value,
        timescale: TIMESCALE,
        ..least_duration
    };
    expose(&device, &Exposure { duration, iso });
    Some(held)
}

/// Restores an exposure.
pub fn restore(held: &Exposure) {
    if let Some(device) = device() {
        expose(&device, held);
    }
}

/// Sets an exposure, which the camera holds.
fn expose(device: &AVCaptureDevice, exposure: &Exposure) {
    let custom = AVCaptureExposureMode::Custom;
    // SAFETY: the device is locked, has the mode, and both values are within its ranges.
    set(device, || unsafe {
        if device.isExposureModeSupported(custom) {
            let Exposure { duration, iso } = *exposure;
            device.setExposureModeCustomWithDuration_ISO_completionHandler(duration, iso, None);
        }
    });
}

fn seconds(time: CMTime) -> f64 {
    let CMTime { value, timescale, .. } = time;
    let value = value as f64;
    value / f64::from(timescale)
}
