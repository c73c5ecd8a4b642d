//! One session of ARCore: its objects, its configuration, and the calls that may fail.

use std::cell::Cell;

use super::card;
use super::ffi::{
    ArAnchor, ArAugmentedImageDatabase, ArCameraIntrinsics, ArConfig, ArFocusMode, ArFrame,
    ArLightEstimationMode, ArPose, ArSession, ArTrackableList, Functions,
};
use super::modes::Modes;
use super::owned::Owned;
use super::status::{Failure, NOTHING, UNSUPPORTED_CONFIGURATION};
use crate::java::Java;

/// `AR_UPDATE_MODE_LATEST_CAMERA_IMAGE`: an update never waits.
const LATEST_IMAGE: i32 = 1;
/// `AR_PLANE_FINDING_MODE_DISABLED`.
const NO_PLANES: i32 = 0;
/// `AR_PLANE_FINDING_MODE_HORIZONTAL`: tables.
const LEVEL_PLANES: i32 = 1;
/// `AR_TEXTURE_UPDATE_MODE_EXPOSE_HARDWARE_BUFFER`: the only mode without OpenGL.
const WITHOUT_GL: i32 = 1;
/// `AR_LIGHT_ESTIMATION_MODE_DISABLED`.
const NO_LIGHT: ArLightEstimationMode = 0;
/// `AR_FOCUS_MODE_FIXED`: to a few metres.
const FIXED_FOCUS: ArFocusMode = 0;
/// `AR_FOCUS_MODE_AUTO`: a toy is nearer than the range of a fixed focus.
const AUTO_FOCUS: ArFocusMode = 1;

/// Optional parts of a session, as bits: all of them are requested at first, and fewer if ARCore
/// refuses the configuration.
const CARD: u8 = 1;
const FOCUS: u8 = 2;
const ALL: u8 = CARD | FOCUS;

/// Subsets of the wanted parts, in the order in which they are tried: all, then one part fewer at a
/// time, first without the card.
fn less_and_less(wished: u8) -> Vec<u8> {
    let mut parts: Vec<u8> = (0..=ALL).filter(|part| part & !wished == 0).collect();
    parts.sort_by_key(|part| {
        let dropped = wished & !part;
        (dropped.count_ones(), dropped)
    });
    parts
}

/// Objects that are detected in the camera's picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Finds {
    pub(super) planes: bool,
    pub(super) card: bool,
}

/// An anchor and its requested number.
pub(super) struct HeldAnchor {
    pub(super) id: u64,
    pub(super) anchor: Owned<ArAnchor>,
}

/// A session with the objects into which each of its frames is read. They are released before it,
/// in this order.
pub(super) struct Session {
    pub(super) anchor: Option<HeldAnchor>,
    pub(super) trackables: Owned<ArTrackableList>,
    pub(super) intrinsics: Owned<ArCameraIntrinsics>,
    pub(super) pose: Owned<ArPose>,
    pub(super) frame: Owned<ArFrame>,
    /// The card's image; `None` without a card, or if ARCore refuses it.
    card: Option<Owned<ArAugmentedImageDatabase>>,
    modes: Modes,
    session: Owned<ArSession>,
    pub(super) api: Functions,
    finds: Finds,
    /// Parts that ARCore refused.
    refused: u8,
    focuses: bool,
    /// `Surface.ROTATION_*`.
    rotation: Cell<i32>,
    /// Quarter turns of the picture if the display is not rotated: the rotation of the sensor in
    /// the phone.
    sensor_turns: Cell<u8>,
}

/// The value for the sensors of nearly all phones.
const USUAL_TURNS: u8 = 1;

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to 3"
)]
fn quarter(turns: i32) -> u8 {
    turns.rem_euclid(4) as u8
}

impl Session {
    /// Creates and configures a session, which is then paused.
    ///
    /// Pictures are no larger than `at_most_px`, if the phone did not deliver larger ones.
    pub(super) fn create(
        api: Functions,
        java: Java,
        finds: Finds,
        at_most_px: Option<[i32; 2]>,
    ) -> Result<Self, Failure> {
        let mut status = 0;
        // SAFETY: the pointers are those of this thread and of a living activity, as the shell got
        // them from Android; a created session is ours to destroy.
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
                // SAFETY: the session lives, and the created object is ours to destroy.
                unsafe { Owned::new(|place| (api.$create)(raw, place), api.$destroy) }.ok_or(NOTHING)?
            };
        }
        // SAFETY: as above; a null pose is the identity.
        let pose = unsafe {
            let identity = std::ptr::null();
            Owned::new(
                |place| (api.ArPose_create)(raw, identity, place),
                api.ArPose_destroy,
            )
        };
        let mut session = Self {
            anchor: None,
            trackables: create!(ArTrackableList_create, ArTrackableList_destroy),
            intrinsics: create!(ArCameraIntrinsics_create, ArCameraIntrinsics_destroy),
            pose: pose.ok_or(NOTHING)?,
            frame: create!(ArFrame_create, ArFrame_destroy),
            card: None,
            modes: Modes::of((&api, &session), at_most_px)?,
            session,
            api,
            finds,
            refused: 0,
            focuses: false,
            rotation: Cell::new(i32::from(USUAL_TURNS)),
            sensor_turns: Cell::new(USUAL_TURNS),
        };
        session.next_mode()?;
        session.configure()?;
        Ok(session)
    }

    pub(super) fn raw(&self) -> *mut ArSession {
        self.session.as_ptr()
    }

    /// Configures the wanted parts, and fewer of them if ARCore refuses; refused parts are not
    /// requested again.
    fn configure(&mut self) -> Result<(), Failure> {
        if self.finds.card && self.card.is_none() && self.refused & CARD == 0 {
            match card::database(&self.api, &self.session) {
                Ok(card) => self.card = Some(card),
                Err(failure) => {
                    eprintln!("arcore: the card is not detected: {failure}");
                    self.refused |= CARD;
                }
            }
        }
        let wished = if self.finds.card { ALL } else { FOCUS } & !self.refused;
        for part in less_and_less(wished) {
            match self.configure_with(part) {
                Err(Failure(UNSUPPORTED_CONFIGURATION)) => {}
                configured => {
                    configured?;
                    if part != wished {
                        eprintln!(
                            "arcore: of card (1) and autofocus (2), {wished} was refused and {part} is used"
                        );
                        self.refused |= wished & !part;
                    }
                    self.focuses = part & FOCUS != 0;
                    return Ok(());
                }
            }
        }
        Err(Failure(UNSUPPORTED_CONFIGURATION))
    }

    fn configure_with(&self, part: u8) -> Result<(), Failure> {
        let (api, raw) = (&self.api, self.raw());
        // SAFETY: the session lives, and the created object is ours to destroy.
        let config: Option<Owned<ArConfig>> =
            unsafe { Owned::new(|place| (api.ArConfig_create)(raw, place), api.ArConfig_destroy) };
        let config = config.ok_or(NOTHING)?;
        let planes = if self.finds.planes {
            LEVEL_PLANES
        } else {
            NO_PLANES
        };
        let focus = if part & FOCUS == 0 {
            FIXED_FOCUS
        } else {
            AUTO_FOCUS
        };
        // SAFETY: session, configuration and database live.
        Failure::check(unsafe {
            let config = config.as_ptr();
            (api.ArConfig_setUpdateMode)(raw, config, LATEST_IMAGE);
            (api.ArConfig_setPlaneFindingMode)(raw, config, planes);
            (api.ArConfig_setTextureUpdateMode)(raw, config, WITHOUT_GL);
            (api.ArConfig_setLightEstimationMode)(raw, config, NO_LIGHT);
            (api.ArConfig_setFocusMode)(raw, config, focus);
            if let Some(card) = self.card.as_ref().filter(|_| part & CARD != 0) {
                (api.ArConfig_setAugmentedImageDatabase)(raw, config, card.as_ptr());
            }
            (api.ArSession_configure)(raw, config)
        })
    }

    /// Detects these objects from now on, and no others; objects found before stay.
    pub(super) fn find(&mut self, finds: Finds) -> Result<(), Failure> {
        if self.finds == finds {
            return Ok(());
        }
        self.finds = finds;
        self.configure()
    }

    /// Whether the card is wanted and was refused.
    pub(super) fn lacks_card(&self) -> bool {
        self.finds.card && self.refused & CARD != 0
    }

    /// Whether the camera does not focus automatically although that was requested, as on some
    /// phones until they are paused and resumed (arcore-android-sdk issues 1300 and 1543).
    pub(super) fn is_focus_stuck(&self) -> bool {
        self.focuses && self.focuses_by_itself() == Some(false)
    }

    /// Sets the camera of a paused session to the next smaller of its modes; returns whether there
    /// is one.
    pub(super) fn next_mode(&mut self) -> Result<bool, Failure> {
        self.modes.next((&self.api, &self.session))
    }

    /// Chosen width and height of the camera's picture.
    pub(super) fn mode_px(&self) -> Option<[i32; 2]> {
        Some(self.modes.used?.size_px)
    }

    /// Quarter turns of the shown picture, as far as they are known.
    pub(super) fn quarter_turns(&self) -> u8 {
        quarter(i32::from(self.sensor_turns.get()) - self.rotation.get())
    }

    /// Derives the rotation of the sensor from the present quarter turns of the picture and the
    /// display's rotation.
    pub(super) fn learn_turns(&self, turns: u8) {
        self.sensor_turns
            .set(quarter(i32::from(turns) + self.rotation.get()));
    }

    pub(super) fn resume(&self) -> Result<(), Failure> {
        // SAFETY: the session lives.
        Failure::check(unsafe { (self.api.ArSession_resume)(self.raw()) })
    }

    pub(super) fn pause(&self) -> Result<(), Failure> {
        // SAFETY: the session lives.
        Failure::check(unsafe { (self.api.ArSession_pause)(self.raw()) })
    }

    /// Makes the session process the camera's latest frame.
    pub(super) fn update(&self) -> Result<(), Failure> {
        // SAFETY: session and frame live.
        Failure::check(unsafe { (self.api.ArSession_update)(self.raw(), self.frame.as_ptr()) })
    }

    /// Sets the display's quarter turns, in the numbers of `Surface.ROTATION_*`, and its size.
    pub(super) fn set_display(&self, quarter_turns: i32, [width, height]: [i32; 2]) {
        self.rotation.set(quarter_turns);
        // SAFETY: the session lives.
        unsafe { (self.api.ArSession_setDisplayGeometry)(self.raw(), quarter_turns, width, height) }
    }
}
