//! CPU reference of `common/reflection.wgsl`: the reflection of a glossy receiver.

use glam::{DVec3, DVec4};

use super::model::ReceiverPoint;

/// Reflectance of glass or varnish at normal incidence.
const ALONG_NORMAL: f64 = 0.04;
/// Published constants of the fit of a rough dielectric's reflectance: factors of the roughness,
/// and summands.
const C0: DVec4 = DVec4::new(-1.0, -0.0275, -0.572, 0.022);
const C1: DVec4 = DVec4::new(1.0, 0.0425, 1.04, -0.04);

/// Reflection of the first receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Channel of the visibilities with the share of the lobe that the toy does not hide.
    pub channel: usize,
    /// Roughness as Beckmann's alpha.
    pub alpha: f64,
    /// Light of the surroundings.
    pub surroundings: DVec3,
    /// Light of the toy less that of the surroundings.
    pub toy_above_surroundings: DVec3,
    /// The camera's centre in the receiver's space.
    pub eye_in_plane: DVec3,
}

impl Reflection {
    /// Light that a point reflects to the camera, relative to the gain, with `part` of the toy's
    /// image.
    #[must_use]
    pub fn light(&self, point: ReceiverPoint, visibility: DVec4, part: f64) -> DVec3 {
        if point.receiver != 0 {
            return DVec3::ZERO;
        }
        let at = DVec3::new(point.in_plane.x, 0.0, point.in_plane.y);
        let cosine = (self.eye_in_plane - at).normalize().y;
        let hidden = part * (1.0 - visibility[self.channel]);
        self.reflectance(cosine) * (self.surroundings + hidden * self.toy_above_surroundings)
    }

    fn reflectance(&self, cosine: f64) -> f64 {
        let r = self.alpha.sqrt() * C0 + C1;
        let a004 = (r.x * r.x).min((-9.28 * cosine).exp2()) * r.x + r.y;
        ALONG_NORMAL * (-1.04 * a004 + r.z) + 1.04 * a004 + r.w
    }
}
