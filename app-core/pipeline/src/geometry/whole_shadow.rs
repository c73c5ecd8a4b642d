//! Whether all of a shape casts its shadow where a camera may see it, so that nothing of it needs to be cut off.

use glam::{Vec3, Vec4, Vec4Swizzles};

/// What rounding in 32 bits may add to a ball, as a share of its radius.
const ROUNDING: f32 = 1e-3;

/// A ball that holds a shape, in the space of a receiver.
#[derive(Clone, Copy, Debug)]
pub struct Caster {
    /// Its middle.
    pub centre: Vec3,
    /// In metres.
    pub radius_m: f32,
}

impl Caster {
    /// Whether a light point, (position, 1) or (unit direction, 0), is above all of it, and all of its shadow is farther than
    /// `near_m` before the camera. `depth` is that of the receiver's point (x, z, 1).
    ///
    /// Both are told by functions that are linear in a point of the shape: with its shadow s = (x, z, w), `flatten` of the
    /// shaders, these are w and depth . s - near w.
    #[must_use]
    pub fn has_whole_shadow(&self, light: Vec4, depth: Vec3, near_m: f32) -> bool {
        let beyond = depth - near_m * Vec3::Z;
        let rise = depth.x * light.x + depth.y * light.z + beyond.z * light.w;
        let before = Vec3::new(light.y * depth.x, -rise, light.y * depth.y);
        let above = Vec3::new(0.0, -light.w, 0.0);
        let least = |gradient: Vec3, at_origin: f32| {
            at_origin + gradient.dot(self.centre) - (1.0 + ROUNDING) * self.radius_m * gradient.length()
        };
        least(above, light.y) > 0.0 && least(before, beyond.z * light.y) > 0.0 && light.xyz().is_finite()
    }
}
