//! The choice of the camera's mode: the largest picture that is delivered.
//!
//! Not every phone delivers all pictures that it lists: one with a Snapdragon 662 freezes at 1920 x
//! 1080 and runs at 1280 x 720 (arcore-android-sdk issue 1251). Therefore the modes are tried in an
//! order.

use super::ffi::{ArCameraConfig, ArCameraConfigFilter, ArCameraConfigList, ArSession, Functions};
use super::owned::Owned;
use super::status::{Failure, NOTHING};

/// `AR_CAMERA_CONFIG_FACING_DIRECTION_BACK`: away from the person.
const BACK: i32 = 0;
/// `AR_CAMERA_CONFIG_TARGET_FPS_30`.
const AT_30_HZ: u32 = 1;
/// `AR_CAMERA_CONFIG_DEPTH_SENSOR_USAGE_DO_NOT_USE`.
const WITHOUT_DEPTH: u32 = 2;

/// Maximum size of a requested picture, in pixels along its longer side.
const MAX_SIDE_PX: i32 = 1920;
/// Frame rate above which a phone becomes hot.
const MAX_HZ: i32 = 30;

/// A mode of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CameraMode {
    /// Width and height of the picture that the processor gets.
    pub size_px: [i32; 2],
    /// Maximum frame rate.
    pub hz: i32,
    /// Whether the camera faces away from the person.
    pub faces_away: bool,
}

impl CameraMode {
    fn n_pixels(&self) -> i64 {
        n_pixels(self.size_px)
    }
}

fn n_pixels([width, height]: [i32; 2]) -> i64 {
    i64::from(width) * i64::from(height)
}

/// The modes in the order in which they are tried, one for each size: first the largest picture
/// within 1920 pixels, then smaller ones, and finally larger ones, the smallest of them first; for
/// each size the mode nearest to 30 Hz. Modes larger than `at_most_px`, which a phone did not
/// deliver, are left out, unless there are no others.
#[must_use]
pub fn order_of(modes: &[CameraMode], at_most_px: Option<[i32; 2]>) -> Vec<usize> {
    let mut order: Vec<(usize, &CameraMode)> = modes
        .iter()
        .enumerate()
        .filter(|(_, mode)| mode.faces_away)
        .collect();
    let rank = |mode: &CameraMode| {
        let is_small = mode.size_px.iter().all(|side| *side <= MAX_SIDE_PX);
        let size = if is_small {
            -mode.n_pixels()
        } else {
            mode.n_pixels()
        };
        (!is_small, size, mode.size_px, (mode.hz - MAX_HZ).abs())
    };
    order.sort_by_key(|(_, mode)| rank(mode));
    order.dedup_by_key(|(_, mode)| mode.size_px);
    let delivered: Vec<usize> = order
        .iter()
        .filter(|(_, mode)| at_most_px.is_none_or(|most| mode.n_pixels() <= n_pixels(most)))
        .map(|(index, _)| *index)
        .collect();
    if delivered.is_empty() {
        order.into_iter().map(|(index, _)| index).collect()
    } else {
        delivered
    }
}

/// A session, and the functions for its queries.
pub(super) type Of<'a> = (&'a Functions, &'a Owned<ArSession>);

/// The modes of a session, in the order in which they are tried.
pub(super) struct Modes {
    list: Owned<ArCameraConfigList>,
    mode: Owned<ArCameraConfig>,
    modes: Vec<CameraMode>,
    /// Modes not yet tried.
    left: std::vec::IntoIter<usize>,
    /// The mode in use; `None` if the camera stays in ARCore's default mode.
    pub(super) used: Option<CameraMode>,
}

impl Modes {
    /// Modes of a camera that faces away from the person, at 30 Hz and without a depth sensor; all
    /// modes if there is none.
    pub(super) fn of((api, session): Of<'_>, at_most_px: Option<[i32; 2]>) -> Result<Self, Failure> {
        let raw = session.as_ptr();
        // SAFETY: the session lives, and the created objects are ours to destroy.
        let (list, mode) = unsafe {
            (
                Owned::new(
                    |place| (api.ArCameraConfigList_create)(raw, place),
                    api.ArCameraConfigList_destroy,
                ),
                Owned::new(
                    |place| (api.ArCameraConfig_create)(raw, place),
                    api.ArCameraConfig_destroy,
                ),
            )
        };
        let mut modes = Self {
            list: list.ok_or(NOTHING)?,
            mode: mode.ok_or(NOTHING)?,
            modes: Vec::new(),
            left: Vec::new().into_iter(),
            used: None,
        };
        for is_filtered in [true, false] {
            modes.modes = modes.listed((api, session), is_filtered)?;
            let order = order_of(&modes.modes, at_most_px);
            if !order.is_empty() {
                modes.left = order.into_iter();
                break;
            }
        }
        Ok(modes)
    }

    fn listed(&self, (api, session): Of<'_>, is_filtered: bool) -> Result<Vec<CameraMode>, Failure> {
        let raw = session.as_ptr();
        // SAFETY: the session lives, and the created object is ours to destroy.
        let filter: Option<Owned<ArCameraConfigFilter>> = unsafe {
            Owned::new(
                |place| (api.ArCameraConfigFilter_create)(raw, place),
                api.ArCameraConfigFilter_destroy,
            )
        };
        let filter = filter.ok_or(NOTHING)?;
        let mut n_modes = 0;
        // SAFETY: session, filter and list live, and the count is a variable of ours.
        unsafe {
            if is_filtered {
                (api.ArCameraConfigFilter_setFacingDirection)(raw, filter.as_ptr(), BACK);
                (api.ArCameraConfigFilter_setTargetFps)(raw, filter.as_ptr(), AT_30_HZ);
                (api.ArCameraConfigFilter_setDepthSensorUsage)(raw, filter.as_ptr(), WITHOUT_DEPTH);
            }
            (api.ArSession_getSupportedCameraConfigsWithFilter)(raw, filter.as_ptr(), self.list.as_ptr());
            (api.ArCameraConfigList_getSize)(raw, self.list.as_ptr(), &raw mut n_modes);
        }
        Ok((0..n_modes)
            .map(|index| self.read((api, session), index))
            .collect())
    }

    /// Reads a mode of the list by its index, which is below the list's size.
    fn get(&self, (api, session): Of<'_>, index: i32) {
        // SAFETY: session, list and mode live, and the index is below the list's size.
        unsafe {
            let get = api.ArCameraConfigList_getItem;
            get(session.as_ptr(), self.list.as_ptr(), index, self.mode.as_ptr());
        }
    }

    fn read(&self, (api, session): Of<'_>, index: i32) -> CameraMode {
        self.get((api, session), index);
        let ([mut width, mut height], [mut slowest, mut hz], mut facing) = ([0; 2], [0; 2], BACK);
        let (raw, config) = (session.as_ptr(), self.mode.as_ptr());
        // SAFETY: session and mode live, and the numbers are variables of ours.
        unsafe {
            (api.ArCameraConfig_getImageDimensions)(raw, config, &raw mut width, &raw mut height);
            (api.ArCameraConfig_getFpsRange)(raw, config, &raw mut slowest, &raw mut hz);
            (api.ArCameraConfig_getFacingDirection)(raw, config, &raw mut facing);
        }
        CameraMode {
            size_px: [width, height],
            hz,
            faces_away: facing == BACK,
        }
    }

    /// Sets the camera of a paused session to the next mode; returns whether there is one.
    pub(super) fn next(&mut self, (api, session): Of<'_>) -> Result<bool, Failure> {
        let Some(index) = self.left.next() else {
            return Ok(false);
        };
        self.get((api, session), i32::try_from(index).map_err(|_| NOTHING)?);
        self.used = self.modes.get(index).copied();
        // SAFETY: session and mode live; the session is paused.
        Failure::check(unsafe { (api.ArSession_setCameraConfig)(session.as_ptr(), self.mode.as_ptr()) })?;
        Ok(true)
    }
}
