//! Receivers whose plane space begins near the toy, wherever their own begins.
//!
//! Shaders have 32 bits: coordinates are kept small, so that a receiver may begin a kilometre away from the toy.

use glam::{DMat4, DVec2, DVec3};

use crate::geometry::rect::PlaneRect;
use crate::scene::{Receiver, Surface};

/// Plane spaces begin at multiples of this along the receiver's own axes, so that they stay when the toy is moved a little.
const STEP_M: f64 = 0.0625;

/// A receiver in a plane space of its own: y = 0, its normal along +Y, its origin below the toy.
#[derive(Clone, Debug, PartialEq)]
pub struct AnchoredReceiver {
    /// Rigid.
    pub world_from_plane: DMat4,
    /// Where the receiver ends.
    pub rect: PlaneRect,
    /// How it looks.
    pub surface: Surface,
}

impl AnchoredReceiver {
    /// Begins the plane space of `receiver` near a toy that stands at `toy_in_world`.
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
