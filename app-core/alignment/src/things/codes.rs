//! Pictures in sRGB codes, in which differences are roughly proportional to their visibility.

use glam::IVec2;

use crate::median::median;
use crate::picture::{Color, Picture, index_in, places};
use app_scene::geometry::color::srgb_from_linear;

/// Difference in codes from which two colours count as different.
pub(super) const UNLIKE_CODES: f32 = 12.0;

/// A picture in sRGB codes, 0 to 255; NaN where nothing is known.
#[derive(Clone, Debug)]
pub(super) struct Codes {
    pub(super) size_px: IVec2,
    pub(super) pixels: Vec<Color>,
}

impl Codes {
    pub(super) fn of(picture: &Picture) -> Self {
        Self::exposed(picture, [1.0; 3])
    }

    /// A picture whose linear light is multiplied, such as a plate by the frame's exposure over its own: a
    /// surface differs by 5 codes if two exposures differ by 6 to 11 %.
    pub(super) fn exposed(picture: &Picture, gains: Color) -> Self {
        let code = |color: Color| codes_of([0, 1, 2].map(|channel| gains[channel] * color[channel]));
        let code = |at| picture.get(at).map_or([f32::NAN; 3], code);
        Self {
            size_px: picture.size_px,
            pixels: places(picture.size_px).map(code).collect(),
        }
    }

    pub(super) fn get(&self, at: IVec2) -> Option<Color> {
        let color = self.pixels[index_in(self.size_px, at)?];
        (!color[0].is_nan()).then_some(color)
    }
}

/// A colour of linear light in codes.
pub(super) fn codes_of(color: Color) -> Color {
    color.map(|linear| 255.0 * srgb_from_linear(linear))
}

/// Smallest difference in codes that counts as a change, and its multiple of the median difference,
/// which is the noise and the drift of the exposure.
const CHANGED_CODES: f32 = 2.0;
const OF_NOISE: f32 = 3.0;

/// The difference in codes from which on a place of a picture has changed, by the differences of
/// its known places.
pub(crate) fn least_change(apart: impl Iterator<Item = f32>) -> f32 {
    let noise = median(apart, f32::total_cmp).unwrap_or(0.0);
    CHANGED_CODES.max(OF_NOISE * noise)
}

/// Largest difference of a channel.
pub(super) fn apart(a: Color, b: Color) -> f32 {
    (0..3)
        .map(|channel| (a[channel] - b[channel]).abs())
        .fold(0.0, f32::max)
}

/// Distance of a colour from another in less light, in codes.
pub(super) fn from_shaded(color: Color, lit: Color) -> f32 {
    let square: f32 = lit.iter().map(|code| code * code).sum();
    let product: f32 = lit.iter().zip(color).map(|(lit, code)| lit * code).sum();
    let light = if square > 0.0 {
        (product / square).clamp(0.0, 1.0)
    } else {
        1.0
    };
    apart(color, lit.map(|code| light * code))
}
