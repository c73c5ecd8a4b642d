//! One session of ARCore: its objects, how it is configured, and the calls that may fail.

use super::card;
use super::ffi::{
    ArAnchor, ArAugmentedImageDatabase, ArCameraConfig, ArCameraConfigFilter, ArCameraConfigList,
    ArCameraIntrinsics, ArConfig, ArFrame, ArLightEstimate, ArLightEstimationMode, ArPose, ArSession,
    ArTrackableList, Functions,
};
use super::owned::Owned;
use super::status::{Failure, NOTHING, UNSUPPORTED_CONFIGURATION};
use crate::java::Java;

/// `AR_UPDATE_MODE_LATEST_CAMERA_IMAGE`: an update never waits.
const LATEST_IMAGE: i32 = 1;
/// `AR_PLANE_FINDING_MODE_DISABLED`.
const NO_PLANES: i32 = 0;
/// `AR_PLANE_FINDING_MODE_HORIZONTAL`: tables.
const LEVEL_PLANES: i32 = 1;
/// `AR_TEXTURE_UPDATE_MODE_EXPOSE_HARDWARE_BUFFER`: the one mode without OpenGL.
const WITHOUT_GL: i32 = 1;
/// `AR_LIGHT_ESTIMATION_MODE_DISABLED`.
const NO_LIGHT: ArLightEstimationMode = 0;
/// `AR_LIGHT_ESTIMATION_MODE_ENVIRONMENTAL_HDR`.
const HDR_LIGHT: ArLightEstimationMode = 2;

/// Most pixels of a camera's picture that is asked for, along its longer side.
const MAX_SIDE_PX: i32 = 1920;
/// Frames a second beyond which a phone grows hot.
const MAX_HZ: i32 = 30;

/// What a camera can be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CameraMode {
    /// Width and height of the picture that the processor gets.
    pub size_px: [i32; 2],
    /// Most frames a second.
    pub hz: i32,
}

/// The mode that is taken: the largest picture within 1920 pixels, of those the one nearest to 30 Hz; the smallest where
/// all are larger. None of none.
#[must_use]
pub fn best_mode(modes: &[CameraMode]) -> Option<usize> {
    let n_pixels = |mode: &CameraMode| i64::from(mode.size_px[0]) * i64::from(mode.size_px[1]);
    let rank = |mode: &CameraMode| {
        let is_small = mode.size_px.iter().all(|side| *side <= MAX_SIDE_PX);
        let size = if is_small { n_pixels(mode) } else { -n_pixels(mode) };
        (is_small, size, -(mode.hz - MAX_HZ).abs())
    };
    (0..modes.len()).max_by_key(|index| modes.get(*index).map(rank))
}

/// An anchor and the number that it was asked for by.
pub(super) struct HeldAnchor {
    pub(super) id: u64,
    pub(super) anchor: Owned<ArAnchor>,
}

/// A session with the objects that each of its frames is read into. They are given back before it, in this order.
pub(super) struct Session {
    pub(super) anchor: Option<HeldAnchor>,
    pub(super) light: Owned<ArLightEstimate>,
    pub(super) trackables: Owned<ArTrackableList>,
    pub(super) intrinsics: Owned<ArCameraIntrinsics>,
    pub(super) pose: Owned<ArPose>,
    pub(super) frame: Owned<ArFrame>,
    /// What the card is known by; none where ARCore does not take it.
    card: Option<Owned<ArAugmentedImageDatabase>>,
    session: Owned<ArSession>,
    pub(super) api: Functions,
    has_light: bool,
    finds_planes: bool,
}

impl Session {
    /// Creates and configures a session, which is then paused.
    pub(super) fn create(api: Functions, java: Java, finds_planes: bool) -> Result<Self, Failure> {
        let mut status = 0;
        // SAFETY: the pointers are those of this thread and of a living activity, as the shell has them from Android; a
        // session that was created is ours to destroy.
        let session = unsafe {
            Owned::new(
                |place| status = (api.ArSession_create)(java.env, java.activity, place),
                api.ArSession_destroy,
            )
        };
        Failure::check(status)?;
        let session = session.ok_or(NOTHING)?;
        let raw = session.as_ptr();
        macro_rules! create {
            ($create:ident, $destroy:ident) => {
                // SAFETY: the session lives, and what it creates is ours to destroy.
                unsafe { Owned::new(|place| (api.$create)(raw, place), api.$destroy) }.ok_or(NOTHING)?
            };
        }
        // SAFETY: as above; no pose is given, which stands for the identity.
        let pose = unsafe {
            let identity = std::ptr::null();
            Owned::new(
                |place| (api.ArPose_create)(raw, identity, place),
                api.ArPose_destroy,
            )
        };
        let mut session = Self {
            anchor: None,
            light: create!(ArLightEstimate_create, ArLightEstimate_destroy),
            trackables: create!(ArTrackableList_create, ArTrackableList_destroy),
            intrinsics: create!(ArCameraIntrinsics_create, ArCameraIntrinsics_destroy),
            pose: pose.ok_or(NOTHING)?,
            frame: create!(ArFrame_create, ArFrame_destroy),
            card: card::database(&api, &session)
                .inspect_err(|failure| eprintln!("arcore: the card is not looked for: {failure}"))
                .ok(),
            session,
            api,
            has_light: true,
            finds_planes,
        };
        session.choose_camera()?;
        session.configure()?;
        Ok(session)
    }

    pub(super) fn raw(&self) -> *mut ArSession {
        self.session.as_ptr()
    }

    /// Whether light is estimated, which not every phone does.
    pub(super) fn has_light(&self) -> bool {
        self.has_light
    }

    /// Sets the camera to the best of its modes; where it names none, it stays as ARCore has it.
    fn choose_camera(&self) -> Result<(), Failure> {
        let (api, raw) = (&self.api, self.raw());
        // SAFETY: the session lives, and what it creates is ours to destroy.
        let (filter, list, mode) = unsafe {
            let filter: Option<Owned<ArCameraConfigFilter>> = Owned::new(
                |place| (api.ArCameraConfigFilter_create)(raw, place),
                api.ArCameraConfigFilter_destroy,
            );
            let list: Option<Owned<ArCameraConfigList>> = Owned::new(
                |place| (api.ArCameraConfigList_create)(raw, place),
                api.ArCameraConfigList_destroy,
            );
            let mode: Option<Owned<ArCameraConfig>> = Owned::new(
                |place| (api.ArCameraConfig_create)(raw, place),
                api.ArCameraConfig_destroy,
            );
            (filter.ok_or(NOTHING)?, list.ok_or(NOTHING)?, mode.ok_or(NOTHING)?)
        };
        let mut n_modes = 0;
        // SAFETY: session, filter and list live, and the count is a place of ours.
        unsafe {
            (api.ArSession_getSupportedCameraConfigsWithFilter)(raw, filter.as_ptr(), list.as_ptr());
            (api.ArCameraConfigList_getSize)(raw, list.as_ptr(), &raw mut n_modes);
        }
        // SAFETY: session, list and mode live, and the index is below the list's size.
        let get =
            |index| unsafe { (api.ArCameraConfigList_getItem)(raw, list.as_ptr(), index, mode.as_ptr()) };
        let modes: Vec<CameraMode> = (0..n_modes)
            .map(|index| {
                get(index);
                let ([mut width, mut height], [mut slowest, mut hz]) = ([0; 2], [0; 2]);
                // SAFETY: session and mode live, and the numbers are places of ours.
                unsafe {
                    let config = mode.as_ptr();
                    (api.ArCameraConfig_getImageDimensions)(raw, config, &raw mut width, &raw mut height);
                    (api.ArCameraConfig_getFpsRange)(raw, config, &raw mut slowest, &raw mut hz);
                }
                let size_px = [width, height];
                CameraMode { size_px, hz }
            })
            .collect();
        let Some(best) = best_mode(&modes).and_then(|index| i32::try_from(index).ok()) else {
            return Ok(());
        };
        get(best);
        // SAFETY: session and mode live; the session has not been resumed yet.
        Failure::check(unsafe { (api.ArSession_setCameraConfig)(raw, mode.as_ptr()) })
    }

    /// Asks for light, and does without where the phone has none.
    fn configure(&mut self) -> Result<(), Failure> {
        match self.configure_with(HDR_LIGHT) {
            Err(Failure(UNSUPPORTED_CONFIGURATION)) => {
                self.has_light = false;
                self.configure_with(NO_LIGHT)
            }
            result => result,
        }
    }

    fn configure_with(&self, light: ArLightEstimationMode) -> Result<(), Failure> {
        let (api, raw) = (&self.api, self.raw());
        // SAFETY: the session lives, and what it creates is ours to destroy.
        let config: Option<Owned<ArConfig>> =
            unsafe { Owned::new(|place| (api.ArConfig_create)(raw, place), api.ArConfig_destroy) };
        let config = config.ok_or(NOTHING)?;
        // SAFETY: session and configuration live.
        Failure::check(unsafe {
            let config = config.as_ptr();
            (api.ArConfig_setUpdateMode)(raw, config, LATEST_IMAGE);
            let planes = if self.finds_planes {
                LEVEL_PLANES
            } else {
                NO_PLANES
            };
            (api.ArConfig_setPlaneFindingMode)(raw, config, planes);
            (api.ArConfig_setTextureUpdateMode)(raw, config, WITHOUT_GL);
            (api.ArConfig_setLightEstimationMode)(raw, config, light);
            if let Some(card) = &self.card {
                (api.ArConfig_setAugmentedImageDatabase)(raw, config, card.as_ptr());
            }
            (api.ArSession_configure)(raw, config)
        })
    }

    /// Looks for level planes from now on, or no longer; those that were found stay.
    pub(super) fn find_planes(&mut self, finds_planes: bool) -> Result<(), Failure> {
        if self.finds_planes == finds_planes {
            return Ok(());
        }
        self.finds_planes = finds_planes;
        self.configure_with(if self.has_light { HDR_LIGHT } else { NO_LIGHT })
    }

    pub(super) fn resume(&self) -> Result<(), Failure> {
        // SAFETY: the session lives.
        Failure::check(unsafe { (self.api.ArSession_resume)(self.raw()) })
    }

    pub(super) fn pause(&self) -> Result<(), Failure> {
        // SAFETY: the session lives.
        Failure::check(unsafe { (self.api.ArSession_pause)(self.raw()) })
    }

    /// Lets the session look at the camera's latest frame.
    pub(super) fn update(&self) -> Result<(), Failure> {
        // SAFETY: session and frame live.
        Failure::check(unsafe { (self.api.ArSession_update)(self.raw(), self.frame.as_ptr()) })
    }

    /// Tells the display's quarter turns, as `Surface.ROTATION_*` counts them, and its size.
    pub(super) fn set_display(&self, quarter_turns: i32, [width, height]: [i32; 2]) {
        // SAFETY: the session lives.
        unsafe { (self.api.ArSession_setDisplayGeometry)(self.raw(), quarter_turns, width, height) }
    }
}
