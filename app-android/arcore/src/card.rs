//! The printed card, which ARCore follows as an image.

use std::ffi::CStr;

use app_core::card::{PATTERN_M, reference};
use glam::DMat4;

use super::ffi::{ArAugmentedImage, ArAugmentedImageDatabase, ArSession, ArTrackable, Functions};
use super::frame::{STOPPED, TRACKING};
use super::owned::Owned;
use super::session::{NOTHING, Session};
use super::status::Failure;
use crate::convert;

/// `AR_TRACKABLE_AUGMENTED_IMAGE`.
const IMAGES: i32 = 0x4152_0104;
/// `AR_AUGMENTED_IMAGE_TRACKING_METHOD_FULL_TRACKING`: it is seen in this frame.
const IS_SEEN: i32 = 1;
const NAME: &CStr = c"card";

/// Images to look for: the card alone.
pub(super) fn database(
    api: &Functions,
    session: &Owned<ArSession>,
) -> Result<Owned<ArAugmentedImageDatabase>, Failure> {
    let raw = session.as_ptr();
    // SAFETY: the session lives, and what it creates is ours to destroy.
    let database = unsafe {
        Owned::new(
            |place| (api.ArAugmentedImageDatabase_create)(raw, place),
            api.ArAugmentedImageDatabase_destroy,
        )
    };
    let database: Owned<ArAugmentedImageDatabase> = database.ok_or(NOTHING)?;
    let pattern = reference();
    let [width, height] = pattern.size_px.map(|side| i32::try_from(side).unwrap_or(0));
    let (codes, mut index) = (pattern.codes.as_ptr(), 0);
    #[allow(clippy::cast_possible_truncation, reason = "15 cm")]
    let width_m = PATTERN_M as f32;
    // SAFETY: session and database live, the name ends with a zero, and the codes are rows of so many pixels without padding.
    Failure::check(unsafe {
        let (database, name) = (database.as_ptr(), NAME.as_ptr());
        let add = api.ArAugmentedImageDatabase_addImageWithPhysicalSize;
        add(
            raw,
            database,
            name,
            codes,
            width,
            height,
            width,
            width_m,
            &raw mut index,
        )
    })?;
    Ok(database)
}

impl Session {
    /// Where the card is, while it is seen.
    pub(super) fn card(&self) -> Option<DMat4> {
        let mut found = self.trackables_of(IMAGES);
        found.find_map(|trackable| self.pose_of_card(&trackable))
    }

    fn pose_of_card(&self, trackable: &Owned<ArTrackable>) -> Option<DMat4> {
        let (api, raw) = (&self.api, self.raw());
        // The list was asked for images alone, which are trackables in C by a cast.
        let image: *const ArAugmentedImage = trackable.as_ptr().cast_const().cast();
        let (mut state, mut method) = (STOPPED, 0);
        // SAFETY: session, image and pose live, and the numbers are places of ours.
        unsafe {
            (api.ArTrackable_getTrackingState)(raw, trackable.as_ptr(), &raw mut state);
            (api.ArAugmentedImage_getTrackingMethod)(raw, image, &raw mut method);
            (api.ArAugmentedImage_getCenterPose)(raw, image, self.pose.as_ptr());
        }
        // A pose is one in the same numbers, whatever it is of.
        let world_from_card = convert::world_from_camera(self.pose_raw(&self.pose));
        world_from_card.filter(|_| state == TRACKING && method == IS_SEEN)
    }
}
