//! Pictures in the format of phones' cameras.

use app_core::camera_frame::{CodeRange, LumaCoefficients, PlanarImage, PlaneError, Planes, YcbcrEncoding};
use app_core::scene::Image;
use glam::DVec3;

use reference::camera_planes::encoded;

/// The encoding of most phones' planes.
pub const BT601_FULL: YcbcrEncoding = YcbcrEncoding {
    coefficients: LumaCoefficients::Bt601,
    range: CodeRange::Full,
};

#[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
fn code(value: f64) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}

/// `image` as planes: chroma is the mean over four pixels.
///
/// # Errors
/// When its size is invalid.
pub fn planar(image: &Image, encoding: YcbcrEncoding) -> Result<PlanarImage, PlaneError> {
    let [width, height] = [image.width_px as usize, image.height_px as usize];
    let ycbcr = |x: usize, y: usize| {
        let at = 4 * (y.min(height - 1) * width + x.min(width - 1));
        let [r, g, b] = [0, 1, 2].map(|k| f64::from(image.rgba8[at + k]));
        encoded(encoding, DVec3::new(r, g, b))
    };
    let luma: Vec<u8> = (0..width * height)
        .map(|at| code(ycbcr(at % width, at / width)[0]))
        .collect();
    let [columns, rows] = [width.div_ceil(2), height.div_ceil(2)];
    let chroma: Vec<u8> = (0..columns * rows)
        .flat_map(|at| {
            let (x, y) = (2 * (at % columns), 2 * (at / columns));
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| ycbcr(x + dx, y + dy));
            [1, 2].map(|k| code(four.iter().map(|one| one[k]).sum::<f64>() / 4.0))
        })
        .collect();
    let size_px = [image.width_px, image.height_px];
    PlanarImage::new(&Planes::nv12(
        size_px,
        (&luma, width),
        (&chroma, 2 * columns),
        encoding,
    ))
}
