//! Layout of a scene: receivers, lights and the toy.

use glam::{DMat4, DVec3};

use crate::geometry::anchored::AnchoredReceiver;
use app_scene::scene::Light;

/// Receivers, lights and the position of the toy.
#[derive(Clone, Copy, Debug)]
pub struct SceneLayout<'a> {
    /// The planes that receive the shadow, at least one; those after the fourth are left out. The
    /// first one's plane space is the anchor.
    pub receivers: &'a [AnchoredReceiver],
    /// At most four lights; further ones are left out.
    pub lights: &'a [Light],
    /// Centre of the toy, in anchor space: direct fractions are given at the points of the
    /// receivers nearest to it.
    pub toy_in_anchor: DVec3,
}

impl SceneLayout<'_> {
    /// Transform of anchor space, the first receiver's plane space.
    #[must_use]
    pub fn world_from_anchor(&self) -> DMat4 {
        self.receivers
            .first()
            .map_or(DMat4::IDENTITY, |first| first.world_from_plane)
    }
}
