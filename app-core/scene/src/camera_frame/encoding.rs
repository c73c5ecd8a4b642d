//! The colour encoding of a camera's planes.
//!
//! Source: ITU-R BT.601-7, 2.5, and BT.709-6, 3 and 4 (luma coefficients and quantisation); JFIF
//! 1.02 for full range.

use glam::{Mat3, Vec3};

/// Coefficients of red and blue in luma.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LumaCoefficients {
    /// ITU-R BT.601: the encoding of most phones' camera planes, whatever their size.
    Bt601,
    /// ITU-R BT.709.
    Bt709,
}

/// Range of the codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CodeRange {
    /// Luma from 0 to 255, chroma from 0 to 255 about 128.
    Full,
    /// Luma from 16 to 235, chroma from 16 to 240 about 128.
    Video,
}

/// Encoding of colour as luma and two chroma components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct YcbcrEncoding {
    /// The luma coefficients.
    pub coefficients: LumaCoefficients,
    /// The range of codes.
    pub range: CodeRange,
}

/// Affine map from (luma, Cb, Cr), each from 0 to 1 as in a texture, to sRGB codes from 0 to 1,
/// which may exceed the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SrgbFromYcbcr {
    pub matrix: Mat3,
    /// Luma of black, and chroma of grey.
    pub origin: Vec3,
}

impl YcbcrEncoding {
    /// The map to sRGB codes. As far as phones document it, their camera planes have sRGB's
    /// transfer function.
    pub fn srgb_from_ycbcr(self) -> SrgbFromYcbcr {
        let (red, blue) = match self.coefficients {
            LumaCoefficients::Bt601 => (0.299, 0.114),
            LumaCoefficients::Bt709 => (0.2126, 0.0722),
        };
        let green = 1.0 - red - blue;
        // Codes from black to white, and from one extreme of chroma to the other.
        let (black, luma_codes, chroma_codes) = match self.range {
            CodeRange::Full => (0.0, 255.0, 255.0),
            CodeRange::Video => (16.0, 219.0, 224.0),
        };
        let [from_luma, from_chroma] = [luma_codes, chroma_codes].map(|codes| 255.0 / codes);
        let from_blue = 2.0 * (1.0 - blue) * from_chroma;
        let from_red = 2.0 * (1.0 - red) * from_chroma;
        SrgbFromYcbcr {
            matrix: Mat3::from_cols(
                Vec3::splat(from_luma),
                Vec3::new(0.0, -from_blue * blue / green, from_blue),
                Vec3::new(from_red, -from_red * red / green, 0.0),
            ),
            origin: Vec3::new(black, 128.0, 128.0) / 255.0,
        }
    }
}

impl SrgbFromYcbcr {
    /// sRGB codes from 0 to 1.
    pub(crate) fn decode(&self, ycbcr: Vec3) -> Vec3 {
        (self.matrix * (ycbcr - self.origin)).clamp(Vec3::ZERO, Vec3::ONE)
    }
}
