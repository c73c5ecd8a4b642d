//! The only anchor that ARCore holds for the app.

use app_core::camera_frame::Anchor;
use glam::DMat4;

use super::ffi::{ArPose, TRACKING};
use super::owned::Owned;
use super::session::{HeldAnchor, Session};
use super::status::Failure;
use crate::convert;

impl Session {
    /// Holds a place instead of the previous one, which is released even if the new one cannot be
    /// held.
    pub(super) fn hold(&mut self, id: u64, world_from_anchor: &DMat4) -> Result<(), Failure> {
        let (api, raw) = (self.api, self.raw());
        if let Some(held) = self.anchor.take() {
            // SAFETY: session and anchor live; the reference to the anchor is released when it is
            // dropped.
            unsafe { (api.ArAnchor_detach)(raw, held.anchor.as_ptr()) };
        }
        let numbers = convert::pose_raw(world_from_anchor);
        // SAFETY: the session lives, a pose has seven numbers, and the created object is ours to
        // destroy.
        let pose: Option<Owned<ArPose>> = unsafe {
            Owned::new(
                |place| (api.ArPose_create)(raw, numbers.as_ptr(), place),
                api.ArPose_destroy,
            )
        };
        let pose = pose.ok_or(Failure(-2))?;
        let mut status = 0;
        // SAFETY: session and pose live; an acquired anchor is ours to release.
        let anchor = unsafe {
            Owned::new(
                |place| status = (api.ArSession_acquireNewAnchor)(raw, pose.as_ptr(), place),
                api.ArAnchor_release,
            )
        };
        Failure::check(status)?;
        self.anchor = anchor.map(|anchor| HeldAnchor { id, anchor });
        Ok(())
    }

    /// The anchor's pose, while ARCore tracks it.
    pub(super) fn held(&self) -> Option<Anchor> {
        let held = self.anchor.as_ref()?;
        let mut state = -1;
        // SAFETY: session, anchor and pose live, and the state is a variable of ours.
        unsafe {
            (self.api.ArAnchor_getTrackingState)(self.raw(), held.anchor.as_ptr(), &raw mut state);
            (self.api.ArAnchor_getPose)(self.raw(), held.anchor.as_ptr(), self.pose.as_ptr());
        }
        // A pose has the same numbers for every kind of object.
        let world_from_anchor = convert::world_from_camera(self.pose_raw(&self.pose))?;
        (state == TRACKING).then_some(Anchor {
            id: held.id,
            world_from_anchor,
        })
    }
}
