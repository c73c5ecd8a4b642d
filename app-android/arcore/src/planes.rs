//! Level planes that ARCore has found.

use app_core::camera_frame::FoundPlane;

use super::ffi::{ArPlane, ArTrackable, STOPPED, TRACKING};
use super::owned::Owned;
use super::session::Session;
use crate::convert;

/// `AR_TRACKABLE_PLANE`.
const PLANES: i32 = 0x4152_0101;
/// `AR_PLANE_HORIZONTAL_UPWARD_FACING`.
const UPWARD: i32 = 0;
/// Corners of a plane beyond which its outline is none: ARCore's have a few dozen.
const MAX_CORNERS: usize = 4096;

impl Session {
    pub(super) fn planes(&self) -> Vec<FoundPlane> {
        let found = self.trackables_of(PLANES);
        found
            .filter_map(|trackable| self.found_plane(&trackable))
            .collect()
    }

    /// All that ARCore follows of a kind. The list is of one kind at a time: what is iterated over ends before another is asked for.
    pub(super) fn trackables_of(&self, kind: i32) -> impl Iterator<Item = Owned<ArTrackable>> {
        let (api, raw, list) = (&self.api, self.raw(), self.trackables.as_ptr());
        let mut n_found = 0;
        // SAFETY: session and list live, and the count is a place of ours.
        unsafe {
            (api.ArSession_getAllTrackables)(raw, kind, list);
            (api.ArTrackableList_getSize)(raw, list, &raw mut n_found);
        }
        // SAFETY: the index is below the list's size, and what was acquired is ours to release.
        (0..n_found).filter_map(move |index| unsafe {
            Owned::new(
                |place| (api.ArTrackableList_acquireItem)(raw, list, index, place),
                api.ArTrackable_release,
            )
        })
    }

    /// A level plane that is being tracked. One that ARCore took into another keeps its name and has that one's shape.
    fn found_plane(&self, trackable: &Owned<ArTrackable>) -> Option<FoundPlane> {
        let (api, raw) = (&self.api, self.raw());
        // The list was asked for planes alone, which are trackables in C by a cast.
        let plane: *const ArPlane = trackable.as_ptr().cast_const().cast();
        let (mut state, mut kind, mut n_numbers) = (STOPPED, -1, 0);
        // SAFETY: session, plane and pose live, and the numbers are places of ours.
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
        // SAFETY: session and plane live, and the array is as long as the function asks for.
        unsafe { (api.ArPlane_getPolygon)(raw, plane, numbers.as_mut_ptr()) };
        // A pose is one in the same numbers, whatever it is of.
        let world_from_centre = convert::world_from_camera(self.pose_raw(&self.pose))?;
        let (world_from_plane, half_extent_m) = convert::rectangle(world_from_centre, &numbers)?;
        Some(FoundPlane {
            // Its address in ARCore, the same for the whole session.
            id: trackable.as_ptr().addr().try_into().ok()?,
            world_from_plane,
            half_extent_m,
        })
    }
}
