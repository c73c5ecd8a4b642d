//! What a device makes of sRGB codes, and light as the standard has it.
//!
//! Drivers may decode a code up to half a code off, software drivers by a polynomial, and encode so that a picture that passes through
//! comes out as it came. What is read back as light has to be freed of that, or untouched pixels are no longer the camera's.

use super::FloatMap;
use app_scene::geometry::color::linear_from_srgb;

/// Width and height of the picture of all codes, row by row.
pub(crate) const SIDE: u32 = 16;

/// The light that a device has for each code.
pub(crate) struct Decoding(Vec<f32>);

impl Decoding {
    /// Of the picture of all codes.
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

    /// The standard's light for a device's. What is brighter than white stays as it is.
    pub(crate) fn standard(&self, light: f32) -> f32 {
        let above = self.0.partition_point(|known| *known < light);
        let Some(upper) = self.0.get(above) else {
            return light;
        };
        if *upper == light || above == 0 {
            return linear_from_srgb(above as f32 / 255.0);
        }
        let lower = self.0[above - 1];
        // A share of a code: the curve is straight enough within one.
        let code = above as f32 - (upper - light) / (upper - lower);
        linear_from_srgb(code / 255.0)
    }
}
