//! The part of ARCore's C interface that this shell calls, bound by hand: names and signatures of
//! `arcore_c_api.h` 1.53.
//!
//! The library is not linked. Its functions are looked up when it is loaded, so that the app starts
//! on a phone without ARCore, and so that tests can supply functions of their own.

use std::ffi::{CStr, c_char, c_void};
use std::marker::{PhantomData, PhantomPinned};

macro_rules! opaque {
    ($($name:ident)*) => {$(
        #[doc = concat!("ARCore's `", stringify!($name), "`, of which only addresses are known.")]
        #[repr(C)]
        pub struct $name {
            _bytes: [u8; 0],
            // Neither sent to another thread nor moved.
            _owned: PhantomData<(*mut u8, PhantomPinned)>,
        }
    )*};
}

opaque! {
    ArAnchor ArAugmentedImage ArAugmentedImageDatabase ArCamera ArCameraConfig ArCameraConfigFilter ArCameraConfigList ArCameraIntrinsics ArConfig ArFrame ArImage
    ArImageMetadata ArPlane ArPose ArSession ArTrackable ArTrackableList
}

/// `AR_TRACKING_STATE_TRACKING`.
pub(super) const TRACKING: i32 = 0;
/// `AR_TRACKING_STATE_STOPPED`: never tracked again.
pub(super) const STOPPED: i32 = 2;

/// An entry of a camera's metadata of a picture.
#[allow(non_camel_case_types, reason = "a name of the C interface")]
#[repr(C)]
pub struct ArImageMetadata_const_entry {
    /// Meaning of the entry.
    pub tag: u32,
    /// `ACAMERA_TYPE_*`.
    pub kind: u8,
    /// Number of values.
    pub count: u32,
    /// Pointer to the first value.
    pub data: *const u8,
}

macro_rules! enumeration {
    ($($name:ident)*) => {$(
        #[doc = concat!("ARCore's `", stringify!($name), "`: any number, since later versions have further values.")]
        pub type $name = i32;
    )*};
}

enumeration! {
    ArAugmentedImageTrackingMethod ArAvailability ArCameraConfigFacingDirection ArFocusMode ArImageFormat ArInstallStatus ArLightEstimationMode ArPlaneFindingMode
    ArPlaneType ArStatus ArTextureUpdateMode ArTrackableType ArTrackingFailureReason ArTrackingState ArUpdateMode
}

/// A function that the loaded library does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("ARCore's library has no {name}: it is older than what the app was made for")]
pub struct MissingFunction {
    /// Its name.
    pub name: &'static str,
}

/// A function of the table, for comparison with ARCore's header.
#[derive(Clone, Copy, Debug)]
pub struct Signature {
    /// Name in C.
    pub name: &'static str,
    /// Types of its arguments, in Rust.
    pub arguments: &'static [&'static str],
    /// Return type in Rust; empty for none.
    pub returns: &'static str,
}

macro_rules! functions {
    ($(fn $name:ident($($argument:ty),* $(,)?) $(-> $returns:ty)?;)*) => {
        /// The functions of ARCore's library that this shell calls, by their names in C.
        #[allow(non_snake_case, reason = "names of the C interface")]
        #[derive(Clone, Copy)]
        pub struct Functions {
            $(
                #[doc = concat!("`", stringify!($name), "` of `arcore_c_api.h`.")]
                pub $name: unsafe extern "C" fn($($argument),*) $(-> $returns)?,
            )*
        }

        /// Signatures of the table's functions.
        pub const SIGNATURES: &[Signature] = &[$(
            Signature {
                name: stringify!($name),
                arguments: &[$(stringify!($argument)),*],
                returns: concat!($(stringify!($returns))?),
            },
        )*];

        impl Functions {
            /// Looks up every function.
            ///
            /// # Errors
            /// The first function for which `symbol` has no address.
            ///
            /// # Safety
            /// Each address that is not null is that of the C function of that name, for as long as
            /// the table is used.
            pub unsafe fn look_up(
                mut symbol: impl FnMut(&CStr) -> *const c_void,
            ) -> Result<Self, MissingFunction> {
                Ok(Self {$(
                    $name: {
                        let name = stringify!($name);
                        // A literal, so that nothing but the added end can be a zero.
                        let terminated = CStr::from_bytes_with_nul(concat!(stringify!($name), "\0").as_bytes());
                        let address = symbol(terminated.map_err(|_| MissingFunction { name })?);
                        if address.is_null() {
                            return Err(MissingFunction { name });
                        }
                        // SAFETY: by this function's own contract, the address is that of a
                        // function of this signature.
                        unsafe {
                            std::mem::transmute::<
                                *const c_void,
                                unsafe extern "C" fn($($argument),*) $(-> $returns)?,
                            >(address)
                        }
                    },
                )*})
            }
        }
    };
}

functions! {
    fn ArCoreApk_checkAvailability(*mut c_void, *mut c_void, *mut ArAvailability);
    fn ArCoreApk_requestInstall(*mut c_void, *mut c_void, i32, *mut ArInstallStatus) -> ArStatus;

    fn ArSession_create(*mut c_void, *mut c_void, *mut *mut ArSession) -> ArStatus;
    fn ArSession_destroy(*mut ArSession);
    fn ArSession_configure(*mut ArSession, *const ArConfig) -> ArStatus;
    fn ArSession_resume(*mut ArSession) -> ArStatus;
    fn ArSession_pause(*mut ArSession) -> ArStatus;
    fn ArSession_update(*mut ArSession, *mut ArFrame) -> ArStatus;
    fn ArSession_setDisplayGeometry(*mut ArSession, i32, i32, i32);
    fn ArSession_getSupportedCameraConfigsWithFilter(*const ArSession, *const ArCameraConfigFilter, *mut ArCameraConfigList);
    fn ArSession_setCameraConfig(*const ArSession, *const ArCameraConfig) -> ArStatus;
    fn ArSession_getAllTrackables(*const ArSession, ArTrackableType, *mut ArTrackableList);

    fn ArCameraConfigFilter_create(*const ArSession, *mut *mut ArCameraConfigFilter);
    fn ArCameraConfigFilter_destroy(*mut ArCameraConfigFilter);
    fn ArCameraConfigFilter_setFacingDirection(*const ArSession, *mut ArCameraConfigFilter, ArCameraConfigFacingDirection);
    fn ArCameraConfigFilter_setTargetFps(*const ArSession, *mut ArCameraConfigFilter, u32);
    fn ArCameraConfigFilter_setDepthSensorUsage(*const ArSession, *mut ArCameraConfigFilter, u32);
    fn ArCameraConfigList_create(*const ArSession, *mut *mut ArCameraConfigList);
    fn ArCameraConfigList_destroy(*mut ArCameraConfigList);
    fn ArCameraConfigList_getSize(*const ArSession, *const ArCameraConfigList, *mut i32);
    fn ArCameraConfigList_getItem(*const ArSession, *const ArCameraConfigList, i32, *mut ArCameraConfig);
    fn ArCameraConfig_create(*const ArSession, *mut *mut ArCameraConfig);
    fn ArCameraConfig_destroy(*mut ArCameraConfig);
    fn ArCameraConfig_getImageDimensions(*const ArSession, *const ArCameraConfig, *mut i32, *mut i32);
    fn ArCameraConfig_getFpsRange(*const ArSession, *const ArCameraConfig, *mut i32, *mut i32);
    fn ArCameraConfig_getFacingDirection(*const ArSession, *const ArCameraConfig, *mut ArCameraConfigFacingDirection);

    fn ArConfig_create(*const ArSession, *mut *mut ArConfig);
    fn ArConfig_destroy(*mut ArConfig);
    fn ArConfig_setUpdateMode(*const ArSession, *mut ArConfig, ArUpdateMode);
    fn ArConfig_setPlaneFindingMode(*const ArSession, *mut ArConfig, ArPlaneFindingMode);
    fn ArConfig_setLightEstimationMode(*const ArSession, *mut ArConfig, ArLightEstimationMode);
    fn ArConfig_setFocusMode(*const ArSession, *mut ArConfig, ArFocusMode);
    fn ArConfig_setAugmentedImageDatabase(*const ArSession, *mut ArConfig, *const ArAugmentedImageDatabase);
    fn ArConfig_setTextureUpdateMode(*const ArSession, *mut ArConfig, ArTextureUpdateMode);

    fn ArFrame_create(*const ArSession, *mut *mut ArFrame);
    fn ArFrame_destroy(*mut ArFrame);
    fn ArFrame_getTimestamp(*const ArSession, *const ArFrame, *mut i64);
    fn ArFrame_acquireCamera(*const ArSession, *const ArFrame, *mut *mut ArCamera);
    fn ArFrame_acquireCameraImage(*mut ArSession, *mut ArFrame, *mut *mut ArImage) -> ArStatus;
    fn ArFrame_acquireImageMetadata(*const ArSession, *const ArFrame, *mut *mut ArImageMetadata) -> ArStatus;

    fn ArCamera_release(*mut ArCamera);
    fn ArCamera_getPose(*const ArSession, *const ArCamera, *mut ArPose);
    fn ArCamera_getDisplayOrientedPose(*const ArSession, *const ArCamera, *mut ArPose);
    fn ArCamera_getTrackingState(*const ArSession, *const ArCamera, *mut ArTrackingState);
    fn ArCamera_getTrackingFailureReason(*const ArSession, *const ArCamera, *mut ArTrackingFailureReason);
    fn ArCamera_getImageIntrinsics(*const ArSession, *const ArCamera, *mut ArCameraIntrinsics);
    fn ArCameraIntrinsics_create(*const ArSession, *mut *mut ArCameraIntrinsics);
    fn ArCameraIntrinsics_destroy(*mut ArCameraIntrinsics);
    fn ArCameraIntrinsics_getFocalLength(*const ArSession, *const ArCameraIntrinsics, *mut f32, *mut f32);
    fn ArCameraIntrinsics_getPrincipalPoint(*const ArSession, *const ArCameraIntrinsics, *mut f32, *mut f32);
    fn ArCameraIntrinsics_getImageDimensions(*const ArSession, *const ArCameraIntrinsics, *mut i32, *mut i32);

    fn ArPose_create(*const ArSession, *const f32, *mut *mut ArPose);
    fn ArPose_destroy(*mut ArPose);
    fn ArPose_getPoseRaw(*const ArSession, *const ArPose, *mut f32);

    fn ArImage_release(*mut ArImage);
    fn ArImage_getWidth(*const ArSession, *const ArImage, *mut i32);
    fn ArImage_getHeight(*const ArSession, *const ArImage, *mut i32);
    fn ArImage_getFormat(*const ArSession, *const ArImage, *mut ArImageFormat);
    fn ArImage_getNumberOfPlanes(*const ArSession, *const ArImage, *mut i32);
    fn ArImage_getPlaneData(*const ArSession, *const ArImage, i32, *mut *const u8, *mut i32);
    fn ArImage_getPlanePixelStride(*const ArSession, *const ArImage, i32, *mut i32);
    fn ArImage_getPlaneRowStride(*const ArSession, *const ArImage, i32, *mut i32);

    fn ArImageMetadata_release(*mut ArImageMetadata);
    fn ArImageMetadata_getConstEntry(*const ArSession, *const ArImageMetadata, u32, *mut ArImageMetadata_const_entry) -> ArStatus;

    fn ArTrackableList_create(*const ArSession, *mut *mut ArTrackableList);
    fn ArTrackableList_destroy(*mut ArTrackableList);
    fn ArTrackableList_getSize(*const ArSession, *const ArTrackableList, *mut i32);
    fn ArTrackableList_acquireItem(*const ArSession, *const ArTrackableList, i32, *mut *mut ArTrackable);
    fn ArTrackable_release(*mut ArTrackable);
    fn ArTrackable_getTrackingState(*const ArSession, *const ArTrackable, *mut ArTrackingState);
    fn ArPlane_getType(*const ArSession, *const ArPlane, *mut ArPlaneType);
    fn ArPlane_getCenterPose(*const ArSession, *const ArPlane, *mut ArPose);
    fn ArPlane_getPolygonSize(*const ArSession, *const ArPlane, *mut i32);
    fn ArPlane_getPolygon(*const ArSession, *const ArPlane, *mut f32);

    fn ArAugmentedImageDatabase_create(*const ArSession, *mut *mut ArAugmentedImageDatabase);
    fn ArAugmentedImageDatabase_destroy(*mut ArAugmentedImageDatabase);
    fn ArAugmentedImageDatabase_addImageWithPhysicalSize(*const ArSession, *mut ArAugmentedImageDatabase, *const c_char, *const u8, i32, i32, i32, f32, *mut i32) -> ArStatus;
    fn ArAugmentedImage_getCenterPose(*const ArSession, *const ArAugmentedImage, *mut ArPose);
    fn ArAugmentedImage_getTrackingMethod(*const ArSession, *const ArAugmentedImage, *mut ArAugmentedImageTrackingMethod);

    fn ArSession_acquireNewAnchor(*mut ArSession, *const ArPose, *mut *mut ArAnchor) -> ArStatus;
    fn ArAnchor_getPose(*const ArSession, *const ArAnchor, *mut ArPose);
    fn ArAnchor_getTrackingState(*const ArSession, *const ArAnchor, *mut ArTrackingState);
    fn ArAnchor_detach(*mut ArSession, *mut ArAnchor);
    fn ArAnchor_release(*mut ArAnchor);
}
