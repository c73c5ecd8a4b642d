//! Inputs of the search for things.

use glam::DMat4;

use super::memory::Memory;
use super::seeds::Colored;
use crate::measured_points::MeasuredPoints;
use crate::picture::Pyramid;
use crate::pose::Paint;
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::Light;

/// Inputs of the search for things.
pub(crate) struct Sight<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) paint: &'a Paint,
    pub(crate) receivers: &'a [SeenReceiver],
    pub(crate) pyramid: &'a Pyramid,
    pub(crate) lights: &'a [Light],
    pub(crate) world_from_camera: &'a DMat4,
    /// Points by each source that measured some; of use to planes alone.
    pub(crate) points: &'a [MeasuredPoints],
    /// Things whose planes are searched for, if any are.
    pub(crate) planes_of: Option<Colored>,
    /// Memory of the search in the previous picture; `None` for a picture by itself.
    pub(crate) memory: Option<&'a Memory>,
}

impl Sight<'_> {
    /// A receiver's space from the world.
    pub(super) fn plane_from_world(&self, receiver: &SeenReceiver) -> DMat4 {
        receiver.plane_from_camera * self.world_from_camera.inverse()
    }
}
