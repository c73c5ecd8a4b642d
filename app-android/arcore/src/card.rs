//! The printed card, which ARCore tracks as an image.

use std::ffi::CStr;

use app_core::card::{PATTERN_M, reference};

use super::ffi::{ArAugmentedImageDatabase, ArSession, Functions};
use super::owned::Owned;
use super::status::{Failure, NOTHING};

const NAME: &CStr = c"card";

/// Database of the images to detect: the card alone.
pub(super) fn database(
    api: &Functions,
    session: &Owned<ArSession>,
) -> Result<Owned<ArAugmentedImageDatabase>, Failure> {
    let raw = session.as_ptr();
    // SAFETY: the session lives, and the created object is ours to destroy.
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
    // SAFETY: session and database live, the name ends with a zero, and the codes are rows with
    // this number of pixels without padding.
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
