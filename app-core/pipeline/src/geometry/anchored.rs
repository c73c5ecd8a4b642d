//! Receivers whose plane space has its origin near the toy, wherever the receiver's own origin is.
//!
//! Shaders use 32-bit floats: coordinates stay small although a receiver's origin may be a
//! kilometre from the toy.

use glam::{DMat4, DVec2, DVec3};

use crate::geometry::rect::PlaneRect;
use app_scene::scene::{Receiver, Surface};

/// Step of plane-space origins along the receiver's own axes, so that an origin stays when the toy
/// moves a little.
const STEP_M: f64 = 0.0625;

/// A receiver in a plane space of its own: y = 0, its normal along +Y, its origin below the toy.
#[derive(Clone, Debug, PartialEq)]
pub struct AnchoredReceiver {
    /// Rigid transform.
    pub world_from_plane: DMat4,
    /// Extent of the receiver.
    pub rect: PlaneRect,
    /// Its appearance.
    pub surface: Surface,
}

impl AnchoredReceiver {
    /// Puts the origin of `receiver`'s plane space near a toy at `toy_in_world`.
    #[must_use]
    pub fn near(receiver: &Receiver, toy_in_world: DVec3) -> Self {
        let toy = receiver.world_from_plane.inverse().transform_point3(toy_in_world);
        let origin = (DVec2::new(toy.x, toy.z) / STEP_M).round() * STEP_M;
        let own_from_plane = DMat4::from_translation(DVec3::new(origin.x, 0.0, origin.y));
        Self {
            world_from_plane: receiver.world_from_plane * own_from_plane,
            rect: PlaneRect {
                min: -receiver.half_extent_m - origin,
                max: receiver.half_extent_m - origin,
            },
            surface: receiver.surface,
        }
    }
}
