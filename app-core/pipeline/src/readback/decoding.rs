//! Conversion of light as a device decodes it from sRGB codes to the light of the standard.
//!
//! Drivers may decode a code with an error of half a code, software drivers by a polynomial, and
//! encode such that a picture that passes through is unchanged. This error must be removed from
//! light that is read back, or untouched pixels would differ from the camera's.

use super::FloatMap;
use app_scene::geometry::color::linear_from_srgb;

/// Width and height of the picture of all codes, row by row.
pub(crate) const SIDE: u32 = 16;

/// The light of a device for each code.
pub(crate) struct Decoding(Vec<f32>);

impl Decoding {
    /// The decoding measured by the picture of all codes.
    pub(crate) fn new(decoded: &FloatMap) -> Self {
        Self(decoded.texels.iter().map(|texel| texel[0]).collect())
    }

    /// Replaces a device's light by that of the standard.
    pub(crate) fn correct(&self, map: &mut FloatMap) {
        for texel in &mut map.texels {
            let [r, g, b, a] = *texel;
            *texel = [self.standard(r), self.standard(g), self.standard(b), a];
        }
    }

    /// The standard's light for a device's. Light brighter than white stays unchanged.
    pub(crate) fn standard(&self, light: f32) -> f32 {
        let above = self.0.partition_point(|known| *known < light);
        let Some(upper) = self.0.get(above) else {
            return light;
        };
        if *upper == light || above == 0 {
            return linear_from_srgb(above as f32 / 255.0);
        }
        let lower = self.0[above - 1];
        // A fraction of a code: the curve is straight enough within one.
        let code = above as f32 - (upper - light) / (upper - lower);
        linear_from_srgb(code / 255.0)
    }
}
