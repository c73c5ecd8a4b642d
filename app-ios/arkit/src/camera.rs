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

/// Of durations that are set, in parts of a second.
const TIMESCALE: i32 = 1_000_000_000;

/// Whether the camera may be used.
pub fn permission() -> Permission {
    // SAFETY: a constant of AVFoundation.
    let Some(video) = (unsafe { AVMediaTypeVideo }) else {
        return Permission::Unknown;
    };
    // SAFETY: video is one of the two kinds of media that may be asked for.
    convert::permission(unsafe { AVCaptureDevice::authorizationStatusForMediaType(video) }.0)
}

/// Asks the person; the answer is what [`permission`] then says.
pub fn ask_permission() {
    // SAFETY: a constant of AVFoundation.
    let Some(video) = (unsafe { AVMediaTypeVideo }) else {
        return;
    };
    // The answer is looked for with each picture.
    let answered = RcBlock::new(|_is_granted: Bool| {});
    // SAFETY: as above; the block takes what the method hands it, and is retained by it.
    unsafe { AVCaptureDevice::requestAccessForMediaType_completionHandler(video, &answered) };
}

/// An exposure to go back to.
pub struct Exposure {
    duration: CMTime,
    iso: f32,
}

/// The camera of world tracking, which may be told how to expose.
fn device() -> Option<Retained<AVCaptureDevice>> {
    // The class that is asked matters, and the binding has the method on its parent alone.
    // SAFETY: a method of every configuration's class since iOS 16 that returns a device or nil.
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

/// Sets the camera while it is locked for this app.
fn set(device: &AVCaptureDevice, change: impl FnOnce()) {
    // SAFETY: what is locked is unlocked below.
    if let Err(error) = unsafe { device.lockForConfiguration() } {
        eprintln!("arkit: the camera cannot be set: {error}");
        return;
    }
    change();
    // SAFETY: it was locked above.
    unsafe { device.unlockForConfiguration() };
}

/// Holds exposure, white balance and focus as they are, or lets them follow the picture again.
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
    // SAFETY: modes are set while the device is locked, and only those that it has.
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

/// Darkens the picture, and returns the exposure of before; none where the camera cannot.
pub fn underexpose() -> Option<Exposure> {
    let device = device()?;
    // SAFETY: properties of a camera and of the format that it delivers.
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

/// Exposes as before.
pub fn restore(held: &Exposure) {
    if let Some(device) = device() {
        expose(&device, held);
    }
}

/// Exposes so, which the camera holds.
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
