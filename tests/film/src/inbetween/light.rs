//! Pictures in linear light, and the box sums that separate level and detail.

use app_core::scene::Image;
use app_scene::geometry::color::{code_of_linear, linear_of_codes};

/// A picture in linear light, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPicture {
    /// Pixels in a row.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// Red, green and blue of each pixel, from 0 to 1 in a decoded picture.
    pub rgb: Vec<[f32; 3]>,
}

impl LightPicture {
    /// Decodes a picture of sRGB codes.
    #[must_use]
    pub fn of(image: &Image) -> Self {
        let linear = linear_of_codes();
        let pixels = image.rgba8.chunks_exact(4);
        Self {
            width_px: image.width_px as usize,
            height_px: image.height_px as usize,
            rgb: pixels
                .map(|texel| [0, 1, 2].map(|channel| linear[usize::from(texel[channel])]))
                .collect(),
        }
    }

    /// Encodes it as sRGB codes, alpha 255. NaN becomes black.
    #[must_use]
    pub fn encoded(&self) -> Image {
        let mut rgba8 = Vec::with_capacity(4 * self.rgb.len());
        for pixel in &self.rgb {
            rgba8.extend(pixel.map(code_of_linear));
            rgba8.push(u8::MAX);
        }
        let side = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
        Image {
            width_px: side(self.width_px),
            height_px: side(self.height_px),
            rgba8,
        }
    }
}

/// Values of each pixel, averaged over squares of `2 * reach_px + 1` three times, which is close to
/// a Gaussian with a standard deviation of `reach_px + 0.5`. Values outside of the picture count as
/// 0: divide by the same average of a picture of ones.
#[must_use]
pub fn smoothed<const N: usize>(
    mut values: Vec<[f32; N]>,
    width_px: usize,
    reach_px: usize,
) -> Vec<[f32; N]> {
    if width_px == 0 || values.is_empty() {
        return values;
    }
    let height_px = values.len() / width_px;
    let mut line = Vec::new();
    for _ in 0..3 {
        for row in 0..height_px {
            average(&mut values, (row * width_px, 1, width_px), reach_px, &mut line);
        }
        for column in 0..width_px {
            average(&mut values, (column, width_px, height_px), reach_px, &mut line);
        }
    }
    values
}

/// Averages one line: its first index, the step to the next and their number.
fn average<const N: usize>(
    values: &mut [[f32; N]],
    (first, step, n): (usize, usize, usize),
    reach_px: usize,
    line: &mut Vec<[f32; N]>,
) {
    line.clear();
    line.extend((0..n).map(|k| values[first + k * step]));
    let scale = 1.0 / (2 * reach_px + 1) as f64;
    let mut sum = [0.0_f64; N];
    let add = |sum: &mut [f64; N], value: &[f32; N], sign: f64| {
        for channel in 0..N {
            sum[channel] += sign * f64::from(value[channel]);
        }
    };
    line.iter()
        .take(reach_px)
        .for_each(|value| add(&mut sum, value, 1.0));
    for k in 0..n {
        if let Some(entering) = line.get(k + reach_px) {
            add(&mut sum, entering, 1.0);
        }
        #[allow(clippy::cast_possible_truncation, reason = "a mean of singles")]
        let mean = sum.map(|sum| (scale * sum) as f32);
        values[first + k * step] = mean;
        if let Some(leaving) = k.checked_sub(reach_px).and_then(|k| line.get(k)) {
            add(&mut sum, leaving, -1.0);
        }
    }
}
