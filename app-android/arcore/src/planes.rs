//! Horizontal planes that ARCore has found.

use app_core::camera_frame::FoundPlane;

use super::ffi::{ArPlane, ArTrackable, STOPPED, TRACKING};
use super::owned::Owned;
use super::session::Session;
use crate::convert;

/// `AR_TRACKABLE_PLANE`.
const PLANES: i32 = 0x4152_0101;
/// `AR_PLANE_HORIZONTAL_UPWARD_FACING`.
const UPWARD: i32 = 0;
/// Number of corners above which an outline counts as invalid: ARCore's have a few dozen.
const MAX_CORNERS: usize = 4096;

impl Session {
    pub(super) fn planes(&self) -> Vec<FoundPlane> {
        let found = self.trackables_of(PLANES);
        found
            .filter_map(|trackable| self.found_plane(&trackable))
            .collect()
    }

    /// All of ARCore's trackables of a kind. The list is for one kind at a time: an iteration must
    /// end before the next begins.
    pub(super) fn trackables_of(&self, kind: i32) -> impl Iterator<Item = Owned<ArTrackable>> {
        let (api, raw, list) = (&self.api, self.raw(), self.trackables.as_ptr());
        let mut n_found = 0;
        // SAFETY: session and list live, and the count is a variable of ours.
        unsafe {
            (api.ArSession_getAllTrackables)(raw, kind, list);
            (api.ArTrackableList_getSize)(raw, list, &raw mut n_found);
        }
        // SAFETY: the index is below the list's size, and the acquired object is ours to release.
        (0..n_found).filter_map(move |index| unsafe {
            Owned::new(
                |place| (api.ArTrackableList_acquireItem)(raw, list, index, place),
                api.ArTrackable_release,
            )
        })
    }

    /// A horizontal plane that is tracked. A plane that ARCore merged into another keeps its name
    /// and has the other's shape.
    fn found_plane(&self, trackable: &Owned<ArTrackable>) -> Option<FoundPlane> {
        let (api, raw) = (&self.api, self.raw());
        // The list contains only planes, which are trackables in C by a cast.
        let plane: *const ArPlane = trackable.as_ptr().cast_const().cast();
        let (mut state, mut kind, mut n_numbers) = (STOPPED, -1, 0);
        // SAFETY: session, plane and pose live, and the numbers are variables of ours.
        unsafe {
            (api.ArTrackable_getTrackingState)(raw, trackable.as_ptr(), &raw mut state);
            (api.ArPlane_getType)(raw, plane, &raw mut kind);
            (api.ArPlane_getCenterPose)(raw, plane, self.pose.as_ptr());
            (api.ArPlane_getPolygonSize)(raw, plane, &raw mut n_numbers);
        }
        let n_numbers = usize::try_from(n_numbers).unwrap_or(0);
        if state != TRACKING || kind != UPWARD || n_numbers > 2 * MAX_CORNERS {
            return None;
        }
        let mut numbers = vec![0.0_f32; n_numbers];
        // SAFETY: session and plane live, and the array has the length that the function reported.
        unsafe { (api.ArPlane_getPolygon)(raw, plane, numbers.as_mut_ptr()) };
        // A pose has the same numbers for every kind of object.
        let world_from_centre = convert::world_from_camera(self.pose_raw(&self.pose))?;
        let (world_from_plane, half_extent_m) = convert::rectangle(world_from_centre, &numbers)?;
        Some(FoundPlane {
            // The address in ARCore, which stays the same for the whole session.
            id: trackable.as_ptr().addr().try_into().ok()?,
            world_from_plane,
            half_extent_m,
        })
    }
}
