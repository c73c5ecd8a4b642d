//! CPU reference of `camera_planes.wgsl`: decodes planes of luma and chroma.

use app_core::camera_frame::{CodeRange, LumaCoefficients, YcbcrEncoding};
use glam::DVec3;

/// sRGB codes, from 0 to 255 and not rounded, of codes of luma, Cb and Cr: BT.601-7, 2.5.1, and BT.709-6, 3.2 and 3.4, solved
/// for red, green and blue.
#[must_use]
pub fn decoded(encoding: YcbcrEncoding, [luma, blue, red]: [f64; 3]) -> DVec3 {
    let (y, pb, pr) = match encoding.range {
        CodeRange::Full => (luma / 255.0, (blue - 128.0) / 255.0, (red - 128.0) / 255.0),
        CodeRange::Video => (
            (luma - 16.0) / 219.0,
            (blue - 128.0) / 224.0,
            (red - 128.0) / 224.0,
        ),
    };
    let (r, b) = match encoding.coefficients {
        LumaCoefficients::Bt601 => (y + 1.402 * pr, y + 1.772 * pb),
        LumaCoefficients::Bt709 => (y + 1.5748 * pr, y + 1.8556 * pb),
    };
    let g = match encoding.coefficients {
        LumaCoefficients::Bt601 => (y - 0.299 * r - 0.114 * b) / 0.587,
        LumaCoefficients::Bt709 => (y - 0.2126 * r - 0.0722 * b) / 0.7152,
    };
    255.0 * DVec3::new(r, g, b).clamp(DVec3::ZERO, DVec3::ONE)
}

/// Codes of luma, Cb and Cr, not rounded, of sRGB codes from 0 to 255.
#[must_use]
pub fn encoded(encoding: YcbcrEncoding, srgb: DVec3) -> [f64; 3] {
    let [r, g, b] = (srgb / 255.0).to_array();
    let (y, blue_range, red_range) = match encoding.coefficients {
        LumaCoefficients::Bt601 => (0.299 * r + 0.587 * g + 0.114 * b, 1.772, 1.402),
        LumaCoefficients::Bt709 => (0.2126 * r + 0.7152 * g + 0.0722 * b, 1.8556, 1.5748),
    };
    let (pb, pr) = ((b - y) / blue_range, (r - y) / red_range);
    match encoding.range {
        CodeRange::Full => [255.0 * y, 128.0 + 255.0 * pb, 128.0 + 255.0 * pr],
        CodeRange::Video => [16.0 + 219.0 * y, 128.0 + 224.0 * pb, 128.0 + 224.0 * pr],
    }
}

/// Chroma of one component at a pixel, from samples of half the size that lie in the centre of four
/// pixels each: bilinear, with repeated border samples.
#[must_use]
pub fn chroma_at(sample: impl Fn(i64, i64) -> f64, [columns, rows]: [i64; 2], [x, y]: [u32; 2]) -> f64 {
    // A sample k has its centre at 2 k + 1 pixels, and pixel x at x + 1/2.
    let place = |pixel: u32| (f64::from(pixel) + 0.5 - 1.0) / 2.0;
    let (u, v) = (place(x), place(y));
    let mut sum = 0.0;
    for row in [v.floor(), v.floor() + 1.0] {
        for column in [u.floor(), u.floor() + 1.0] {
            let weight = (1.0 - (u - column).abs()) * (1.0 - (v - row).abs());
            #[allow(clippy::cast_possible_truncation, reason = "whole, of a picture's size")]
            let at = (column as i64, row as i64);
            sum += weight * sample(at.0.clamp(0, columns - 1), at.1.clamp(0, rows - 1));
        }
    }
    sum
}
