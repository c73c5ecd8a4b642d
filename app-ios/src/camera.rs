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

use crate::convert;

/// Whether the camera may be used.
pub(crate) fn permission() -> Permission {
    // SAFETY: a constant of AVFoundation.
    let Some(video) = (unsafe { AVMediaTypeVideo }) else {
        return Permission::Unknown;
    };
    // SAFETY: video is one of the two kinds of media that may be asked for.
    convert::permission(unsafe { AVCaptureDevice::authorizationStatusForMediaType(video) }.0)
}

/// Asks the person; the answer is what [`permission`] then says.
pub(crate) fn ask_permission() {
    // SAFETY: a constant of AVFoundation.
    let Some(video) = (unsafe { AVMediaTypeVideo }) else {
        return;
    };
    // The answer is looked for with each picture.
    let answered = RcBlock::new(|_is_granted: Bool| {});
    // SAFETY: as above; the block takes what the method hands it, and is retained by it.
    unsafe { AVCaptureDevice::requestAccessForMediaType_completionHandler(video, &answered) };
}

/// Holds exposure, white balance and focus as they are, or lets them follow the picture again.
pub(crate) fn hold_exposure(is_held: bool) {
    // The class that is asked matters, and the binding has the method on its parent alone.
    // SAFETY: a method of every configuration's class since iOS 16 that returns a device or nil.
    let device: Option<Retained<AVCaptureDevice>> = unsafe {
        msg_send![
            ARWorldTrackingConfiguration::class(),
            configurableCaptureDeviceForPrimaryCamera
        ]
    };
    let Some(device) = device else {
        eprintln!("app-ios: this camera's exposure cannot be held");
        return;
    };
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
    // SAFETY: modes are set while the device is locked for this app, and only those that it has.
    unsafe {
        if let Err(error) = device.lockForConfiguration() {
            eprintln!("app-ios: the camera cannot be set: {error}");
            return;
        }
        if device.isExposureModeSupported(exposure) {
            device.setExposureMode(exposure);
        }
        if device.isWhiteBalanceModeSupported(white_balance) {
            device.setWhiteBalanceMode(white_balance);
        }
        if device.isFocusModeSupported(focus) {
            device.setFocusMode(focus);
        }
        device.unlockForConfiguration();
    }
}
