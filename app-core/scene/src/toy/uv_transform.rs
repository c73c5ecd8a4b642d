//! A material's transform of texture coordinates.
//!
//! Source: the glTF extension `KHR_texture_transform`.

use glam::Vec2;
use serde::Deserialize;

/// Scale first, then rotation, then offset.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default)]
pub(super) struct UvTransform {
    offset: [f32; 2],
    /// Radians, counter-clockwise in the picture with its origin at the top left.
    rotation: f32,
    scale: [f32; 2],
}

impl Default for UvTransform {
    fn default() -> Self {
        Self {
            offset: [0.0; 2],
            rotation: 0.0,
            scale: [1.0; 2],
        }
    }
}

impl UvTransform {
    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        let (sin, cos) = self.rotation.sin_cos();
        let [u, v] = (uv * Vec2::from(self.scale)).to_array();
        Vec2::new(cos * u + sin * v, cos * v - sin * u) + Vec2::from(self.offset)
    }
}
